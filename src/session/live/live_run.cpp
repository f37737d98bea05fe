// SPDX-License-Identifier: BSD-3-Clause
#include "session/live/live_run.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/process/child_process.hpp"
#include "base/text/json_text.hpp"
#include "report/html/page_json.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/text/table.hpp"
#include "session/build_info.hpp"

namespace straytrace::session {
namespace {

// A new file of this user alone; empty: none could be made.
std::string private_file(std::string const& text) {
  std::error_code none;
  std::string name = (std::filesystem::temp_directory_path(none) / "straytrace-XXXXXX.html").string();
  int const descriptor = ::mkstemps(name.data(), int(std::strlen(".html")));
  if (descriptor < 0) return "";
  bool const written = ::write(descriptor, text.data(), text.size()) == ssize_t(text.size());
  ::close(descriptor);
  return written ? name : "";
}

std::vector<std::string> variables_of_this() {
  std::vector<std::string> all;
  for (char** variable = environ; *variable; ++variable) all.emplace_back(*variable);
  return all;
}

}  // namespace

LiveAddress::LiveAddress(std::string const& address, bool open) {
  std::cerr << fmt::format("live page: {}\nThis address is a key: keep it to yourself. Ctrl-C here ends it.\n",
                           address);
  if (!open) return;
  file_ = private_file(fmt::format(
      "<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={}\"><title>straytrace</title>\n", address));
  // Some systems wait here until the browser is closed.
  std::thread([file = file_] {
    FinishedChild const child = run_child({"xdg-open", file}, variables_of_this());
    if (child.start_error != 0 || child.status != 0)
      std::cerr << fmt::format("warning: no browser was opened: {}; open the address yourself\n",
                               child.start_error != 0 ? std::strerror(child.start_error) : "xdg-open failed");
  }).detach();
}

LiveAddress::~LiveAddress() {
  if (!file_.empty()) ::unlink(file_.c_str());
}

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds between_stamps{200};

std::string view_shell(std::string const& title) {
  HtmlPage page;
  page.title = title;
  page.body = "<noscript><p>This page follows a scene and needs scripts.</p></noscript>\n";
  page.data["version"] = fmt::format("{} ({})", build_info::version, build_info::commit);
  page.live = true;
  page.scripts = {"base.js", "live_view.js"};
  return html_text(page);
}

}  // namespace

LiveView::LiveView(std::string title, std::uint16_t port) : page_(view_shell(title)) {
  server_ = std::make_unique<LoopbackServer>(
      port, [this](HttpRequest const& request) { return answer(request); },
      port == 0 ? "run without --live" : "name another port with --live-port, or leave it out for a free one");
}

HttpReply LiveView::answer(HttpRequest const& request) const {
  if (!request.post && request.path == "live") return {200, "text/html; charset=utf-8", page_};
  std::scoped_lock const lock(mutex_);
  if (!request.post && request.path == "picture.html" && pictures_ > 0)
    return {200, "text/html; charset=utf-8", picture_};
  if (!request.post && request.path == "state.json") {
    nlohmann::json const state{
        {"changes", changes_}, {"pictures", pictures_}, {"problems", problems_}, {"warnings", warnings_}};
    return {200, "application/json", json_text(state)};
  }
  return {404, {}, "no such page\n"};
}

void LiveView::show(std::string picture, std::string const& warnings) {
  std::scoped_lock const lock(mutex_);
  picture_ = std::move(picture);
  warnings_ = warnings;
  problems_.clear();
  ++pictures_;
  ++changes_;
}

void LiveView::show_problems(std::string const& text) {
  std::scoped_lock const lock(mutex_);
  problems_ = text;
  ++changes_;
}

SceneFiles::SceneFiles(std::string main_file) : main_(std::move(main_file)) { add(main_.string()); }

void SceneFiles::follow(FileTexts const& texts) {
  seen_.clear();
  add(main_.string());
  for (auto const& [name, text] : texts) add(name);
}

void SceneFiles::follow(std::vector<std::string> const& names) {
  for (std::string const& name : names) add(name);
}

// Texts of the library are files of the program: they have no place here.
void SceneFiles::add(std::string const& name) {
  for (fs::path const& path : {fs::path(name), main_.parent_path() / name}) {
    std::error_code none;
    if (fs::is_regular_file(path, none)) seen_.try_emplace(path.lexically_normal());
  }
  seen_ = stamps();
}

// Editors replace files: one that is missing for a moment counts as changed.
std::map<fs::path, SceneFiles::Stamp> SceneFiles::stamps() const {
  std::map<fs::path, Stamp> now;
  for (auto const& [path, before] : seen_) {
    std::error_code no_time, no_size;
    now[path] = {fs::last_write_time(path, no_time), fs::file_size(path, no_size)};
  }
  return now;
}

bool SceneFiles::wait_for_change(InterruptGuard const& guard) {
  for (bool changed = false; !guard.stop(); std::this_thread::sleep_for(between_stamps)) {
    auto now = stamps();
    if (changed && now == seen_) return true;
    changed = changed || now != seen_;
    seen_ = std::move(now);
  }
  return false;
}

namespace {

constexpr std::size_t live_curves = 8, live_routes = 12, most_error_points = 400;
constexpr double most_live_histories = 1e12;

StopRule error_to_show(Model const& model) {
  if (model.detector) return parse_stop_rule("h_total < 1 %");
  return model.world.receiver_names().empty() ? StopRule{} : parse_stop_rule("receiver:* < 1 %");
}

std::string live_page_of(Model const& model) {
  HtmlPage page;
  page.title = model.scene.title().empty() ? "straytrace run" : model.scene.title();
  page.body =
      "<noscript><p>This page follows a run and needs scripts. Without them, wait for report.html.</p></noscript>\n";
  page.data["version"] = fmt::format("{} ({})", build_info::version, build_info::commit);
  page.data["noise"] = model.detector != nullptr;
  page.plots = page.live = true;
  page.scripts = {"base.js", "plot.js", "live.js"};
  return html_text(page);
}

// The first routes, by the columns that reports show at first.
PageJson live_routes_json(PathTable const& paths) {
  using Writer = TableWriter<RouteRow>;
  Writer const list(route_columns(paths));
  auto columns = list.of(&TableColumn<RouteRow>::page);
  std::erase_if(columns, [](auto const* c) { return !c->shown_first; });
  PageJson out{{"columns", PageJson::array()}, {"rows", PageJson::array()}, {"all", paths.rows.size()}};
  for (auto const* c : columns) {
    std::string const& unit = c->shown_unit();
    out["columns"].push_back(
        {{"title", unit.empty() || unit == "1" ? c->title : fmt::format("{} [{}]", c->title, unit)},
         {"text", c->kind == ColumnKind::text}});
  }
  for (std::size_t i = 0; i < std::min(live_routes, paths.rows.size()); ++i) {
    PageJson cells = PageJson::array();
    for (auto const* c : columns) cells.push_back(Writer::shown(*c, {paths, paths.rows[i]}));
    out["rows"].push_back(std::move(cells));
  }
  return out;
}

// Half of the points, evenly over the run.
template <class Point>
void thin_out(std::vector<Point>& points) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += 2) points[kept++] = points[i];
  points.resize(kept);
}

HttpReply json_reply(PageJson const& data) { return {200, "application/json", json_text(data)}; }

// What the page says after a button: a sentence, and a remedy where there is one.
HttpReply button_reply(unsigned status, std::string const& what, std::string const& remedy = "") {
  HttpReply reply = json_reply({{"what", what}, {"remedy", remedy}});
  reply.status = status;
  return reply;
}

}  // namespace

LiveTarget parse_live_target(std::string const& text, Model const& model, std::uint64_t traced_histories) {
  char const* const examples =
      "write a number of histories, for example 2e6, or a stop rule, for example 'h_total < 1 %'";
  if (is_number(text)) {
    double const n = leading_number(text)->value;
    if (!(n >= 1 && n <= most_live_histories))
      throw InputError(fmt::format("'{}' is not a number of histories", text), examples);
    if (n <= double(traced_histories))
      throw InputError(fmt::format("{:.4g} histories are traced already", double(traced_histories)),
                       "write a larger number, or stop");
    return {std::uint64_t(n), ""};
  }
  if (text.find_first_not_of(" \t") == text.npos) throw InputError("nothing says how far to trace", examples);
  StopRule const rule = parse_stop_rule(text);
  if (auto const complaint = complaint_about(rule, model)) throw InputError(complaint->what, complaint->suggestion);
  return {no_limit, text};
}

LiveRun::LiveRun(Model const& model, std::uint16_t port)
    : model_(model), error_rule_(error_to_show(model)), page_(live_page_of(model)) {
  control_.watch = [this](TraceProgress const& p) { show_progress(p); };
  control_.so_far = [this](TraceResult const& result) { show_result(result); };
  server_ = std::make_unique<LoopbackServer>(
      port, [this](HttpRequest const& request) { return answer(request); },
      port == 0 ? "run without --live" : "name another port with --live-port, or leave it out for a free one");
}

HttpReply LiveRun::answer(HttpRequest const& request) {
  std::string const& path = request.path;
  if (request.post) {
    if (path == "stop") return stop();
    if (path == "extend") return extend(request.body);
    return {404, {}, "no such button\n"};
  }
  if (path == "live") return {200, "text/html; charset=utf-8", page_};
  if (path == "state.json") return {200, "application/json", state()};
  std::scoped_lock const lock(mutex_);
  if (path == "result.json" && !result_.empty()) return {200, "application/json", result_};
  if (path == "report.html" && !report_.empty()) return {200, "text/html; charset=utf-8", report_};
  return {404, {}, "no such page\n"};
}

HttpReply LiveRun::stop() {
  std::scoped_lock const lock(mutex_);
  if (phase_ == Phase::writing) return button_reply(409, "the results are being written", "wait a moment");
  if (phase_ == Phase::finished)
    closed_ = true;
  else
    InterruptGuard::request_stop();
  return button_reply(200, phase_ == Phase::finished ? "the program ends" : "finishing the blocks in progress");
}

HttpReply LiveRun::extend(std::string const& text) {
  std::scoped_lock const lock(mutex_);
  if (phase_ == Phase::writing) return button_reply(409, "the results are being written", "wait a moment");
  try {
    target_ = parse_live_target(text, model_, progress_.histories);
  } catch (InputError const& e) {
    return button_reply(400, e.reason(), e.remedy());
  }
  target_text_ = text;
  if (phase_ != Phase::finished) InterruptGuard::request_stop();
  return button_reply(200, fmt::format("tracing until {}", is_number(text) ? text + " histories" : text));
}

std::string LiveRun::state() const {
  constexpr char const* names[] = {"preparing", "tracing", "writing", "finished"};
  std::scoped_lock const lock(mutex_);
  TraceProgress const& p = progress_;
  bool const by_number = p.wanted_histories > 0 && p.wanted_histories < no_limit;
  return json_reply({{"phase", names[int(phase_)]},
                     {"early", early_},
                     {"histories", p.histories},
                     {"wanted_histories", by_number ? PageJson(p.wanted_histories) : PageJson(nullptr)},
                     {"histories_per_s", number(p.histories_per_s)},
                     {"seconds", number(p.seconds)},
                     {"error", number(p.error)},
                     {"error_histories", p.error_histories},
                     {"wanted_error", p.wanted_error > 0 ? number(p.wanted_error) : PageJson(nullptr)},
                     {"target", target_text_},
                     {"results", results_}})
      .body;
}

void LiveRun::show_progress(TraceProgress const& p) {
  std::scoped_lock const lock(mutex_);
  if (phase_ != Phase::writing) phase_ = Phase::tracing;
  progress_ = p;
}

void LiveRun::show_result(TraceResult const& result) {
  std::string text = result_json(result);
  std::scoped_lock const lock(mutex_);
  result_ = std::move(text);
  ++results_;
}

std::string LiveRun::result_json(TraceResult const& result) {
  std::optional<NoiseBudget> budget;
  if (model_.detector) budget = model_.project(result.coupling);
  PathTable const paths = table_for(result.coupling, budget ? &*budget : nullptr, model_);
  RunContent const content = content_of(model_, result, budget ? &*budget : nullptr);
  double const histories = double(result.total.histories);
  if (error_rule_.by_error())
    if (double const error = stop_rule_error(error_rule_, model_, result.coupling); std::isfinite(error)) {
      if (!errors_.empty() && errors_.back().histories > histories) errors_.clear();  // a small run that began again
      errors_.push_back({histories, error});
      if (errors_.size() > most_error_points) thin_out(errors_);
    }
  PageJson j{{"histories", histories}, {"routes", live_routes_json(paths)}};
  if (budget) {
    j["verdict"] = verdict_sentence(*budget, budget->grid.edges.front(), budget->grid.edges.back());
    j["headline"] = headline(*budget, paths);
    j["budget"] = budget_json(*budget, paths, live_curves);
    j["budget"].erase("shares");
  }
  j["receivers"] =
      content.receivers.empty() ? PageJson::array() : PageJson(receiver_page_list(receiver_table(content)));
  j["errors"] = {{"what", model_.detector ? "h, worst bin of the band" : "light on the worst receiver"},
                 {"histories", PageJson::array()},
                 {"error", PageJson::array()}};
  for (ErrorPoint const& e : errors_) {
    j["errors"]["histories"].push_back(number(e.histories));
    j["errors"]["error"].push_back(number(e.error));
  }
  return json_reply(j).body;
}

bool LiveRun::extended() const {
  std::scoped_lock const lock(mutex_);
  return target_.has_value();
}

void LiveRun::show_writing() {
  std::scoped_lock const lock(mutex_);
  phase_ = Phase::writing;
}

void LiveRun::show_report(std::string html, TraceResult const& result, bool early) {
  show_result(result);
  std::scoped_lock const lock(mutex_);
  report_ = std::move(html);
  progress_.histories = result.total.histories;
  early_ = early;
  phase_ = Phase::finished;
}

std::optional<LiveTarget> LiveRun::wait(InterruptGuard const& guard) {
  for (;; std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
    if (guard.signalled()) return {};
    std::scoped_lock const lock(mutex_);
    if (closed_) return {};
    if (!target_) continue;
    phase_ = Phase::preparing;
    return std::exchange(target_, std::nullopt);
  }
}

}  // namespace straytrace::session
