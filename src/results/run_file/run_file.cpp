// SPDX-License-Identifier: BSD-3-Clause
#include "results/run_file/run_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "io/hdf5/read_write.hpp"
#include "results/results.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/run_file/columns.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/ring/ring_record.hpp"

namespace straytrace::results {
namespace {

constexpr std::size_t user_block = 512;  // smallest user block of HDF5
constexpr std::string_view mark = "straytrace-run sha256 ";
constexpr std::string_view hdf5_mark = "\x89HDF\r\n\x1a\n";

}  // namespace

std::string checksum_header(std::string_view hdf5_image) {
  std::string bytes = fmt::format("{}{} bytes {}\n", mark, sha256(hdf5_image), hdf5_image.size());
  bytes.resize(user_block, '\0');
  return bytes;
}

std::string unsealed(std::string bytes, std::string const& name) {
  if (!bytes.starts_with(mark)) {
    char const* what = bytes.empty()                  ? "the file is empty"
                       : bytes.starts_with(hdf5_mark) ? "it is an HDF5 file of another program"
                                                      : "its first bytes are not those of a run file";
    throw InputError(fmt::format("'{}' is not a straytrace run file: {}", name, what),
                     "name the run.h5 that straytrace run wrote, or a file of straytrace trace");
  }
  std::string const line = bytes.substr(0, bytes.find('\n'));
  if (bytes.size() > user_block) {
    bytes.erase(0, user_block);
    if (line == fmt::format("{}{} bytes {}", mark, sha256(bytes), bytes.size())) return bytes;
  }
  throw InputError(
      fmt::format("'{}' is damaged: its content does not match its checksum; it was cut short, or changed by another "
                  "program",
                  name),
      make_again);
}

namespace {

// Codes of HDF5 for the classes of types.
int class_of(hdf5::Kind kind) { return kind == hdf5::Kind::text ? 3 : kind == hdf5::Kind::real ? 1 : 0; }

void add_values(Sha256& sum, std::string const& name, hdf5::Values const& v) {
  if (v.state != hdf5::State::whole) throw InputError(fmt::format("'{}' cannot be read", name), make_again);
  sum.add_counted(fmt::format("{} type {} of {} [{}]", name, class_of(v.kind), v.size, fmt::join(v.shape, ",")));
  sum.add_counted(v.bytes);
}

void add_attributes(Sha256& sum, hdf5::Object const& object, std::string const& path) {
  for (auto const& [name, values] : object.attributes)
    if (path != "/" || name != "created") add_values(sum, path + "@" + name, values);
}

void add_group(Sha256& sum, hdf5::Reader const& in, std::string const& path) {
  add_attributes(sum, in.object(path), path);
  for (std::string const& name : in.members(path)) {
    std::string const full = path == "/" ? path + name : path + "/" + name;
    if (full == "/timing") continue;
    if (in.is_group(full)) {
      add_group(sum, in, full);
      continue;
    }
    add_values(sum, full, in.object(full).values);
    add_attributes(sum, in.object(full), full);
  }
}

}  // namespace

std::string model_hash(std::span<std::string const> texts) {
  Sha256 sum;
  for (std::string const& text : texts) sum.add_counted(text);
  return sum.hex();
}

std::string data_hash(std::string const& run_file) {
  std::string const image = unsealed(read_file(run_file), run_file);
  try {
    Sha256 sum;
    add_group(sum, hdf5::Reader(hdf5::own_contents(image)), "/");
    return sum.hex();
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}' cannot be compared: {}", run_file, e.reason()), make_again);
  }
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

namespace {

void check_kind(hdf5::Reader const& in, std::string const& file) {
  std::string const kind = in.attribute_text("/", "file_type");
  if (kind != "straytrace-run")
    throw InputError(fmt::format("'{}' is not a straytrace run file: its type is '{}'", file, kind),
                     "name the run.h5 that straytrace run wrote, or a file of straytrace trace");
  std::vector<std::uint64_t> const schema = in.attribute_counts("/", "schema");
  if (schema.front() == std::uint64_t(run_schema_major) || schema.front() == 1) return;
  throw InputError(fmt::format("'{}' has format {} and was written by {} {}; this program reads formats 1 and {}", file,
                               fmt::join(schema, "."), in.attribute_text("/", "program"),
                               in.attribute_text("/", "version"), run_schema_major),
                   "use that version, or make the run again with this one");
}

// Schema 1 differs from schema 2 in the names of some groups and attributes only.
hdf5::Contents with_names_of_schema_2(hdf5::Contents contents) {
  static constexpr std::pair<std::string_view, std::string_view> renamed[] = {
      {"ledger", "energy_balance"}, {"levers", "phase_sensitivities"}, {"lever", "phase_sensitivity"}};
  hdf5::Contents out;
  for (auto& [path, object] : contents) {
    std::string name = path;
    for (auto const& [before, now] : renamed)
      if (auto const at = path.find(before); at != path.npos && path[at - 1] == '/') {
        name.replace(at, before.size(), now);
        break;
      }
    if (path == "/")
      if (auto looks = object.attributes.extract("good_looks")) {
        looks.key() = "good_checks";
        object.attributes.insert(std::move(looks));
      }
    out.emplace(std::move(name), std::move(object));
  }
  return out;
}

constexpr char const* stop_words[] = {"histories", "error", "signal", "time", "checkpoint", "gaps"};  // by Stopped

Stopped read_stop(hdf5::Reader const& in) {
  std::string const word = in.attribute_text("/", "stopped_by");
  auto const found = std::find(std::begin(stop_words), std::end(stop_words), word);
  if (found == std::end(stop_words)) damaged_run(fmt::format("stopped by '{}'", word));
  return Stopped(found - std::begin(stop_words));
}

// Texts of the root: text(name, member) writes or reads each.
template <class Run, class Text>
void root_texts(Run& run, Text const& text) {
  auto& p = run.provenance;
  text("program", p.program);
  text("version", p.version);
  text("commit", p.commit);
  text("build_flags", p.build_flags);
  text("created", p.created);
  text("title", run.title);
  text("model_hash", run.model_hash);
  text("interferometer", run.interferometer);
  text("motion_file", run.motion_file);
}

// Files before schema 1.7 hold whole runs from the first block on.
void read_slice(hdf5::Reader const& in, TraceResult& trace) {
  if (!in.has_attribute("/", "slice")) {
    trace.all_blocks = trace.total.blocks;
    return;
  }
  std::vector<std::uint64_t> const slice = in.attribute_counts("/", "slice");
  if (slice.size() != 2 || slice[0] < 1 || slice[0] > slice[1]) damaged_run("it is an impossible slice");
  trace.slice = {slice[0], slice[1]};
  trace.all_blocks = in.attribute_count("/", "all_blocks");
}

void read_about(hdf5::Reader const& in, RunFile& run) {
  root_texts(run.about, [&](char const* name, std::string& value) { value = in.attribute_text("/", name); });
  run.complete = in.attribute_count("/", "complete") != 0;
  std::uint64_t const block = in.attribute_count("/", "block_size");
  if (block > largest_block || block_size_of(enough_blocks * block) != block)
    damaged_run(fmt::format("blocks of {} histories", block));
}

void read_input(hdf5::Reader const& in, RunContent& run) {
  for (std::size_t i = 0; in.has(fmt::format("/input/files/{}", i)); ++i) {
    std::string const path = fmt::format("/input/files/{}", i);
    std::string text;
    if (in.shape(path).empty()) {
      text = in.text(path);
    } else {
      std::vector<std::uint8_t> const bytes = in.array<std::uint8_t>(path);
      text.assign(bytes.begin(), bytes.end());
    }
    std::string const name = in.attribute_text(path, "name");
    if (in.attribute_text(path, "sha256") != sha256(text))
      damaged_run(fmt::format("input file '{}' has changed", name));
    run.files.emplace(name, std::move(text));
  }
  run.main_file = in.text("/input/main");
  run.overrides = in.strings("/input/overrides");
  run.resolved = in.text("/input/resolved");
}

void read_timing(hdf5::Reader const& in, RunFile& run) {
  std::vector<std::string> const stages = in.strings("/timing/stage");
  std::vector<double> const seconds = in.rows<double>("/timing/seconds", stages.size());
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (stages[i] == "trace")
      run.trace.seconds = seconds[i];
    else if (stages[i] == "noise" && run.noise)
      run.noise->seconds = seconds[i];
    else
      run.about.timing[stages[i]] = seconds[i];
  }
}

}  // namespace

[[noreturn]] void damaged_run(std::string const& what) {
  throw InputError("the run file is damaged: " + what, make_again);
}

std::vector<std::uint64_t> read_offsets(hdf5::Reader const& in, std::string const& path, std::size_t lists,
                                        std::size_t total) {
  std::vector<std::uint64_t> const offset = in.rows<std::uint64_t>(path, lists + 1);
  bool good = offset.front() == 0 && offset.back() == total;
  for (std::size_t i = 0; i < lists; ++i) good = good && offset[i] <= offset[i + 1];
  if (!good) damaged_run(fmt::format("'{}' does not fit its lists", path));
  return offset;
}

RunContent RunFile::content() const {
  RunContent all = about;
  all.trace = &trace;
  all.noise = noise ? &*noise : nullptr;
  return all;
}

namespace {

// The checksum is verified before the HDF5 library, which reads in this process, sees the bytes.
hdf5::Contents verified_contents(std::string const& file, hdf5::Wanted const& wanted = {}) {
  std::string const image = unsealed(read_file(file), file);
  try {
    return hdf5::own_contents(image, wanted);
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}': {}", file, e.reason()), make_again);
  }
}

// Content that `read` takes from a sound file; any fault is an InputError that names the file.
template <class Result, class Read>
Result read_from(hdf5::Contents contents, std::string const& file, Read const& read) {
  hdf5::Reader const in(with_names_of_schema_2(std::move(contents)));
  check_kind(in, file);
  Result result;
  try {
    read(in, result);
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}': {}", file, e.reason()), make_again);
  } catch (std::logic_error const& e) {
    throw InputError(fmt::format("'{}' is damaged: {}", file, e.what()), make_again);
  }
  return result;
}

// No blocks: no light on every group and receiver.
void add_nothing(BlockSums& total, CouplingTable const& table) {
  total.arrived.resize(table.groups.size());
  total.absorbed.resize(table.groups.size() + 1);
  total.receivers.resize(table.receivers.size());
}

void read_all(hdf5::Reader const& in, RunFile& run) {
  read_about(in, run);
  read_input(in, run.about);
  run.trace.coupling = read_classes(in);
  run.trace.tree = read_nodes(in);
  run.trace.total = run.trace.tree.total();
  read_slice(in, run.trace);
  if (run.trace.total.blocks == 0) add_nothing(run.trace.total, run.trace.coupling);
  BlockSums const& total = run.trace.total;
  for (ReceiverSums const& r : total.receivers)
    run.trace.coupling.received_power.push_back(estimate_of_light(r.power, total.histories, total.blocks));
  read_receivers(in, run.trace.coupling.receivers.size(), run.about);
  run.about.importance = read_importance(in, run.trace.coupling.groups.size());
  if (in.has("/projection")) run.about.projection = read_projection(in, run.trace.coupling);
  run.trace.stopped = read_stop(in);
  run.trace.stop_rule = in.attribute_text("/", "stop_rule");
  run.trace.good_checks = std::uint32_t(in.attribute_count("/", "good_checks"));
  run.trace.warnings = in.strings("/warnings/trace");
  if (in.has("/wave")) run.about.waves = std::make_shared<wave::WaveRecord const>(read_wave(in));
  if (in.has("/wave_ring")) run.about.ring = std::make_shared<wave::RingRecord const>(read_ring(in));
  if (in.has("/seam")) run.about.seam = std::make_shared<SeamCheck const>(read_seam(in));
  run.about.warnings = in.strings("/warnings/scene");
  if (in.has("/noise")) run.noise = read_noise(in);
  if (run.noise) find_bounds(*run.noise, run.trace.coupling);
  read_timing(in, run);
}

std::string hash_of_texts(RunContent const& about) {
  std::vector<std::string> texts{about.main_file, about.motion_file};
  texts.insert(texts.end(), about.overrides.begin(), about.overrides.end());
  for (auto const& [name, text] : about.files) texts.insert(texts.end(), {name, text});
  return model_hash(texts);
}

void read_head(hdf5::Reader const& in, PartHead& head) {
  RunFile run;
  read_about(in, run);
  read_input(in, run.about);
  read_timing(in, run);
  head.provenance = run.about.provenance;
  head.model_hash = run.about.model_hash;
  head.texts_hash = hash_of_texts(run.about);
  head.seed = in.attribute_count("/", "seed");
  head.block_size = in.attribute_count("/", "block_size");
  head.seconds = run.trace.seconds;
  head.done = read_done(in);
  for (BlockRange const& range : head.done) run.trace.total.blocks += range.size();
  read_slice(in, run.trace);
  head.slice = run.trace.slice;
  head.all_blocks = std::max(run.trace.all_blocks, head.done.empty() ? 0 : head.done.back().end);
}

}  // namespace

RunFile read_run(std::string const& file) { return run_of(verified_contents(file), file); }

RunFile run_of(hdf5::Contents contents, std::string const& file) {
  return read_from<RunFile>(std::move(contents), file, read_all);
}

PartHead read_part_head(std::string const& file) {
  auto const wanted = [](std::string const& path) {
    return path.starts_with("/input/") || path.starts_with("/timing/") || path == "/nodes/first_block" ||
           path == "/nodes/level";
  };
  PartHead head = read_from<PartHead>(verified_contents(file, {wanted}), file, read_head);
  head.file = file;
  return head;
}

SumTree read_part_sums(std::string const& file) {
  auto const wanted = [](std::string const& path) { return path.starts_with("/nodes/"); };
  return read_from<SumTree>(verified_contents(file, {wanted}), file,
                            [](hdf5::Reader const& in, SumTree& tree) { tree = read_nodes(in); });
}

std::string nodes_image(SumTree const& tree) {
  hdf5::Writer out;
  write_nodes(out, tree);
  return out.bytes();
}

SumTree nodes_of_image(std::string const& image) { return read_nodes(hdf5::Reader(hdf5::own_contents(image))); }

std::string wave_image(wave::WaveRecord const& field) {
  hdf5::Writer out;
  write_wave(out, field);
  return out.bytes();
}

wave::WaveRecord wave_of_image(std::string const& image) { return read_wave(hdf5::Reader(hdf5::own_contents(image))); }

namespace {

void write_about(hdf5::Writer& out, RunContent const& run) {
  auto count = [&](char const* name, std::vector<std::uint64_t> const& value) { out.attribute("/", name, value); };
  out.attribute("/", "file_type", "straytrace-run");
  count("schema", {run_schema_major, run_schema_minor});
  root_texts(run, [&](char const* name, std::string const& value) { out.attribute("/", name, value); });
  out.attribute("/", "stopped_by", stop_words[std::size_t(run.trace->stopped)]);
  out.attribute("/", "stop_rule", run.trace->stop_rule);
  count("good_checks", {run.trace->good_checks});
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
  out.group("/input", "all inputs of the run");
  out.group("/input/files", "input files as read, numbered");
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
  out.group("/warnings", "warnings of the scene and of the trace");
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
  std::vector<Merit> const all = merits(run);
  ColumnWriter const column(out, "/timing/", all);
  column("merit_of", "", &Merit::what);
  column("merit", "1/s", &Merit::value);
}

template <class Row, class Power>
void write_estimates(hdf5::Writer& out, std::string const& path, std::vector<Row> const& rows, Power const& power) {
  ColumnWriter const column(out, path, rows);
  column("mean", "1", through(power, &Estimate::mean));
  column("std_error", "1", through(power, &Estimate::std_error));
}

std::vector<Estimate> estimates(std::vector<Moments> const& all, BlockSums const& of) {
  std::vector<Estimate> rows;
  for (Moments const& m : all) rows.push_back(estimate(m, of.histories, of.blocks));
  return rows;
}

}  // namespace

void write_energy_balance(hdf5::Writer& out, TraceResult const& trace) {
  BlockSums const& total = trace.total;
  out.group("/energy_balance", "mean power per history; emitted equals the sum of the other terms");
  for (auto [name, value] :
       {std::pair{"blocks", total.blocks}, {"bounces", total.bounces}, {"rays", total.rays}, {"lost", total.lost}})
    out.attribute("/energy_balance", name, std::vector<std::uint64_t>{value});
  std::vector<BalanceRow> const rows = balance_rows(total);
  ColumnWriter(out, "/energy_balance/", rows)("name", "", &BalanceRow::name);
  write_estimates(out, "/energy_balance/", rows, &BalanceRow::power);
  out.group("/arrived", "power arriving on each group per history; rows as in /names/groups");
  write_estimates(out, "/arrived/", estimates(total.arrived, total), std::identity{});
  out.group("/absorbed", "power absorbed by each group per history; rows as in /names/groups, then all media");
  write_estimates(out, "/absorbed/", estimates(total.absorbed, total), std::identity{});
}

void write_run(std::string const& file, RunContent const& run) {
  if (!run.trace) throw NumericalError("nothing to write: no trace result");
  try {
    hdf5::Writer out;
    write_about(out, run);
    write_input(out, run);
    write_classes(out, run.trace->coupling);
    write_receivers(out, run);
    write_importance(out, run.importance);
    if (run.projection) write_projection(out, *run.projection);
    write_energy_balance(out, *run.trace);
    write_maps_of(out, run.trace->total);
    write_nodes(out, run.trace->tree);
    if (run.waves) write_wave(out, *run.waves);
    if (run.ring) write_ring(out, *run.ring);
    if (run.seam) write_seam(out, *run.seam);
    if (run.noise) write_noise(out, *run.noise);
    write_warnings(out, run);
    write_timing(out, run);
    std::string_view const image = out.image();
    AtomicFile sealed(file);
    sealed.write(checksum_header(image));
    sealed.write(image);
    sealed.publish();
  } catch (H5::Exception const& e) {
    throw NumericalError(fmt::format("cannot make the run file '{}': HDF5 says '{}'", file, e.getDetailMsg()));
  }
}

}  // namespace straytrace::results
