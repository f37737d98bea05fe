// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "base/message.hpp"
#include "report/merit.hpp"
#include "report/run_parts.hpp"
#include "report/seal.hpp"

namespace straytrace {
namespace {

constexpr char const* stop_words[] = {"histories", "error", "signal", "time", "checkpoint", "gaps"};

void write_about(hdf5::Writer& out, RunContent const& run) {
  auto count = [&](char const* name, std::vector<std::uint64_t> const& value) { out.attribute("/", name, value); };
  out.attribute("/", "file_type", "straytrace-run");
  count("schema", {run_schema_major, run_schema_minor});
  out.attribute("/", "program", run.provenance.program);
  out.attribute("/", "version", run.provenance.version);
  out.attribute("/", "commit", run.provenance.commit);
  out.attribute("/", "build_flags", run.provenance.build_flags);
  out.attribute("/", "created", run.provenance.created);
  out.attribute("/", "title", run.title);
  out.attribute("/", "model_hash", run.model_hash);
  out.attribute("/", "interferometer", run.interferometer);
  out.attribute("/", "stopped_by", stop_words[std::size_t(run.trace->stopped)]);
  out.attribute("/", "stop_rule", run.trace->stop_rule);
  count("good_looks", {run.trace->good_looks});
  out.attribute("/", "motion_file", run.motion_file);
  count("seed", {run.trace->coupling.seed});
  count("histories", {run.trace->coupling.histories});
  count("block_size", {run.trace->coupling.block_size});
  count("slice", {run.trace->slice.number, run.trace->slice.of});
  bool const all = run.trace->slice.whole() && !run.trace->checkpointed();
  count("all_blocks", {all ? run.trace->total.blocks : run.trace->all_blocks});
  count("complete", {!run.trace->checkpointed()});
}

// Whether a fixed-length text holds the content: UTF-8 without zeros. Large ones are better off compressed.
bool stored_as_text(std::string const& content) {
  if (content.size() > std::size_t{1} << 20) return false;
  int following = 0;
  for (char const byte : content) {
    auto const c = static_cast<unsigned char>(byte);
    bool const continues = (c & 0xc0) == 0x80;
    if (c == 0 || c > 0xf4 || continues != (following > 0)) return false;
    if (continues)
      --following;
    else
      following = c < 0x80 ? 0 : c < 0xe0 ? 1 : c < 0xf0 ? 2 : 3;
  }
  return following == 0;
}

void write_input(hdf5::Writer& out, RunContent const& run) {
  out.group("/input", "everything the run was made from");
  out.group("/input/files", "texts as read, by number");
  std::size_t number = 0;
  for (auto const& [name, text] : run.files) {
    std::string const path = fmt::format("/input/files/{}", number++);
    if (stored_as_text(text))
      out.text(path, text);
    else
      out.array(path, std::vector<std::uint8_t>(text.begin(), text.end()), "bytes");
    out.attribute(path, "name", name);
    out.attribute(path, "sha256", sha256(text));
  }
  out.text("/input/main", run.main_file);
  out.strings("/input/overrides", run.overrides);
  out.text("/input/resolved", run.resolved);
}

void write_warnings(hdf5::Writer& out, RunContent const& run) {
  out.group("/warnings", "in words");
  out.strings("/warnings/scene", run.warnings);
  out.strings("/warnings/trace", run.trace->warnings);
}

void write_timing(hdf5::Writer& out, RunContent const& run) {
  std::vector<std::string> stages = {"trace"};
  std::vector<double> seconds = {run.trace->seconds};
  if (run.noise) {
    stages.push_back("noise");
    seconds.push_back(run.noise->seconds);
  }
  for (auto const& [stage, time] : run.timing) {
    stages.push_back(stage);
    seconds.push_back(time);
  }
  out.group("/timing", "wall-clock time; the only group that may differ between equal runs");
  out.strings("/timing/stage", stages);
  out.array("/timing/seconds", seconds, "s");
  std::vector<std::string> of;
  std::vector<double> values;
  for (Merit const& m : merits(run)) {
    of.push_back(m.what);
    values.push_back(m.value);
  }
  out.strings("/timing/merit_of", of);
  out.array("/timing/merit", values, "1/s");
}

void write_estimates(hdf5::Writer& out, std::string const& path, std::vector<Moments> const& all, BlockSums const& of) {
  std::vector<double> mean, error;
  for (Moments const& m : all) {
    Estimate const e = estimate(m, of.histories, of.blocks);
    mean.push_back(e.mean);
    error.push_back(e.std_error);
  }
  out.array(path + "/mean", mean, "1");
  out.array(path + "/std_error", error, "1");
}

}  // namespace

void write_ledger(hdf5::Writer& out, TraceResult const& trace) {
  BlockSums const& total = trace.total;
  out.group("/ledger", "where the light went: mean power per history, emitted = sum of the fates");
  for (auto [name, value] :
       {std::pair{"blocks", total.blocks}, {"bounces", total.bounces}, {"rays", total.rays}, {"lost", total.lost}})
    out.attribute("/ledger", name, std::vector<std::uint64_t>{value});
  std::vector<std::string> names = {"emitted"};
  std::vector<Moments> all = {total.emitted};
  for (int i = 0; i < fate_count; ++i) {
    names.push_back(name_of(Fate(i)));
    all.push_back(total.ledger[std::size_t(i)]);
  }
  out.strings("/ledger/name", names);
  write_estimates(out, "/ledger", all, total);
  out.group("/arrived", "power arriving on each group per history; rows as in /names/groups");
  write_estimates(out, "/arrived", total.arrived, total);
  out.group("/absorbed", "power absorbed by each group per history; rows as in /names/groups, then all media");
  write_estimates(out, "/absorbed", total.absorbed, total);
}

void write_run(std::string const& file, RunContent const& run) {
  if (!run.trace) throw NumericalError("nothing to write: no trace result");
  std::string bytes;
  try {
    hdf5::Writer out;
    write_about(out, run);
    write_input(out, run);
    write_classes(out, run.trace->coupling);
    write_receivers(out, run);
    write_importance(out, run.importance);
    write_ledger(out, *run.trace);
    write_maps_of(out, run.trace->total);
    write_nodes(out, run.trace->tree);
    if (run.noise) write_noise(out, *run.noise);
    write_warnings(out, run);
    write_timing(out, run);
    bytes = out.bytes();
  } catch (H5::Exception const& e) {
    throw NumericalError(fmt::format("cannot make the run file '{}': HDF5 says '{}'", file, e.getDetailMsg()));
  }
  write_file(file, sealed(bytes));
}

}  // namespace straytrace
