// SPDX-License-Identifier: BSD-3-Clause
#include "session/live/live_view.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <system_error>
#include <thread>

#include "report/html/html.hpp"
#include "session/build_info.hpp"

namespace straytrace::session {
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
    return {200, "application/json", state.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
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

}  // namespace straytrace::session
