// SPDX-License-Identifier: BSD-3-Clause
#include "io/loopback_server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <array>
#include <chrono>
#include <exception>
#include <fcntl.h>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "base/errors.hpp"

namespace straytrace::io {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::asio::ip::tcp;
using Request = http::request<http::string_body>;
using Reply = http::response<http::string_body>;

constexpr std::uint32_t most_header = 8192, most_body = 4096;  // bytes
constexpr int most_connections = 32;
constexpr std::chrono::seconds patience{20};  // for a request, and for a reply to be taken

std::string random_token() {
  std::array<unsigned char, 16> bytes;
  if (RAND_bytes(bytes.data(), int(bytes.size())) != 1) throw NumericalError("the system has no random numbers");
  std::string text;
  for (unsigned char const b : bytes) text += fmt::format("{:02x}", b);
  return text;
}

// Takes as long for a token that is almost right.
bool same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

// Programs that this one starts do not keep the port.
template <class Socket>
void close_in_children(Socket& socket) {
  ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
}

std::string_view text_of(beast::string_view v) { return {v.data(), v.size()}; }

}  // namespace

class LoopbackServer::Listener {
 public:
  Listener(std::uint16_t port, Handler handler)
      : handler_(std::move(handler)),
        token_(random_token()),
        acceptor_(context_, tcp::endpoint(asio::ip::address_v4::loopback(), port)),
        host_(fmt::format("127.0.0.1:{}", acceptor_.local_endpoint().port())),
        host_by_name_(fmt::format("localhost:{}", acceptor_.local_endpoint().port())) {
    close_in_children(acceptor_);
    accept();
    thread_ = std::jthread([this] { context_.run(); });
  }
  ~Listener() {
    context_.stop();
    thread_.join();
  }
  Listener(Listener const&) = delete;
  Listener& operator=(Listener const&) = delete;

  std::string address(std::string const& path) const { return fmt::format("http://{}/{}/{}", host_, token_, path); }

 private:
  class Connection;
  void accept();
  HttpReply answer(Request const&) const;

  Handler handler_;
  std::string token_;
  int open_ = 0;  // connections
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  std::string host_, host_by_name_;
  std::jthread thread_;
};

// One connection: requests one after the other, each with limits of size and time. Lives while something waits for it.
class LoopbackServer::Listener::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Listener& listener) : stream_(std::move(socket)), listener_(listener) {
    ++listener_.open_;
  }
  ~Connection() { --listener_.open_; }
  Connection(Connection const&) = delete;
  Connection& operator=(Connection const&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(most_header);
    parser_->body_limit(most_body);
    stream_.expires_after(patience);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error == http::error::end_of_stream || error == beast::error::timeout) return;
      if (error)
        self->write({400, {}, "bad or too long request\n"}, false);
      else
        self->write(self->listener_.answer(self->parser_->get()), self->parser_->get().keep_alive());
    });
  }

 private:
  // No other page may read, frame or remember a reply.
  void write(HttpReply const& given, bool keep) {
    reply_ = Reply(http::status(given.status), 11);
    reply_.set(http::field::content_type, given.type.empty() ? "text/plain; charset=utf-8" : given.type);
    reply_.set(http::field::cache_control, "no-store");
    reply_.set(http::field::x_frame_options, "SAMEORIGIN");
    reply_.set("X-Content-Type-Options", "nosniff");
    reply_.set("Referrer-Policy", "no-referrer");
    reply_.set("Cross-Origin-Resource-Policy", "same-origin");
    reply_.body() = given.body;
    reply_.keep_alive(keep);
    reply_.prepare_payload();
    stream_.expires_after(patience);
    http::async_write(stream_, reply_, [self = shared_from_this(), keep](beast::error_code error, std::size_t) {
      if (!error && keep) return self->read();
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{most_header + most_body};
  std::optional<http::request_parser<http::string_body>> parser_;
  Reply reply_;
  Listener& listener_;
};

void LoopbackServer::Listener::accept() {
  acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error && open_ < most_connections) {
      close_in_children(socket);
      std::make_shared<Connection>(std::move(socket), *this)->read();
    }
    accept();
  });
}

// Who may ask, and what is answered.
HttpReply LoopbackServer::Listener::answer(Request const& request) const {
  std::string_view const host = text_of(request[http::field::host]), origin = text_of(request[http::field::origin]);
  std::string_view target = text_of(request.target());
  target = target.substr(0, target.find('?'));
  if ((host != host_ && host != host_by_name_) || target.size() < token_.size() + 2 || target[0] != '/' ||
      target[token_.size() + 1] != '/' || !same(target.substr(1, token_.size()), token_))
    return {403, {}, "forbidden: use the address that the program printed\n"};
  bool const get = request.method() == http::verb::get, post = request.method() == http::verb::post;
  if (post && !origin.empty() && origin != fmt::format("http://{}", host))
    return {403, {}, "forbidden: the request comes from another page\n"};
  if (!get && !post) return {405, {}, "GET and POST only\n"};
  try {
    return handler_({post, std::string(target.substr(token_.size() + 2)), request.body()});
  } catch (std::exception const& e) {
    return {500, {}, e.what()};
  }
}

LoopbackServer::LoopbackServer(std::uint16_t port, Handler handler, std::string const& remedy) try
    : listener_(std::make_unique<Listener>(port, std::move(handler))) {
} catch (boost::system::system_error const& e) {
  throw InputError(port == 0 ? fmt::format("no port of this machine can be had: {}", e.code().message())
                             : fmt::format("port {} cannot be had: {}", port, e.code().message()),
                   remedy);
}

LoopbackServer::~LoopbackServer() = default;

std::string LoopbackServer::address(std::string const& path) const { return listener_->address(path); }

}  // namespace straytrace::io
