// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <mutex>

#include "api/errors.hpp"
#include "api/source.hpp"
#include "session/session.hpp"

namespace straytrace::api {
namespace {

std::mutex working;  // the flag that stops a trace is that of the whole process

// The scene once more, from the texts that the first reading kept: tracing changes a model.
session::Model read_again(session::Model const& model) {
  return read_model(model.scene.main_file(), model.scene.overrides(), &model.scene.files());
}

TraceOptions options_of(TraceSettings const& settings) {
  TraceOptions options;
  options.quiet = true;
  options.seed = settings.seed;
  options.histories = settings.histories;
  options.until = settings.until;
  options.threads = settings.threads;
  options.max_seconds = settings.max_seconds;
  options.force = settings.overwrite;
  return options;
}

Progress as_public(TraceProgress const& p) {
  return {p.histories, p.wanted_histories, p.seconds, p.histories_per_s, p.error, p.wanted_error};
}

}  // namespace

Model::Model(std::shared_ptr<Source const> source) : source_(std::move(source)) {}

Model Model::read(std::string const& file, std::vector<std::string> const& set) {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    return Model(std::make_shared<Source const>(read_model(file, set)));
  });
}

Model Model::of_text(std::string const& text, std::string const& name, std::vector<std::string> const& set) {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    TextInPlace const held(name, text);
    return Model(std::make_shared<Source const>(read_model(name, set)));
  });
}

std::string Model::title() const { return source_->model.scene.title(); }
std::string Model::hash() const { return source_->model.hash(); }
std::vector<std::string> Model::bodies() const { return source_->model.traced.bodies; }
std::vector<std::string> Model::ports() const { return source_->model.world.ports(); }
std::vector<std::string> Model::receivers() const { return source_->model.world.receiver_names(); }
std::size_t Model::surfaces() const { return source_->model.world.surfaces().size(); }
std::string Model::warnings() const { return source_->model.warnings; }

Run Model::trace(TraceSettings const& settings) const {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    session::Model model = read_again(source_->model);
    TraceOptions const options = options_of(settings);
    apply(options, model);
    std::atomic<bool> stop = false;
    TraceControl control;
    control.stop = &stop;
    control.progress = [&](TraceProgress const& p) {
      if (settings.progress && !settings.progress(as_public(p))) stop = true;
    };
    auto traced = trace_model(model, options, settings.run_file, control);
    RunFile file;
    file.about = content_of(model, traced.result, nullptr);
    file.about.trace = nullptr;
    file.complete = !traced.result.checkpointed();
    file.trace = std::move(traced.result);
    if (!settings.run_file.empty()) write_run(settings.run_file, file.content());
    return Run(std::make_shared<Run::Source const>(std::move(file)));
  });
}

}  // namespace straytrace::api
