// SPDX-License-Identifier: BSD-3-Clause
// Run files: what was written comes back bit by bit, and nothing else is accepted.
#include "results/run_file/run_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <H5Cpp.h>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "io/hdf5/contents.hpp"
#include "io/hdf5/read_write.hpp"
#include "support/message_of.hpp"
#include "unit/results/same.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

class ReportRunFile : public ::testing::Test {
 protected:
  std::string written(std::string const& name = "run.h5") {
    write_run(folder / name, content(trace, &noise));
    return folder / name;
  }
  Folder folder;
  TraceResult trace = trace_result();
  NoiseBudget noise = noise_budget(trace.coupling);
};

TEST_F(ReportRunFile, ComesBackBitByBit) {
  trace.coupling.classes[0].records[3].phase_sensitivities[0].d[4] = -0.0;
  trace.coupling.classes[1].records[3].field = {{{1e-5, -2e-6}, {-0.0, 3e-7}}};
  trace.coupling.classes[1].kind = ClassKind::edge;
  trace.coupling.classes[1].statement = "upper bound: one smooth spherical wave";
  noise.design[0].asd[5] = not_a_number;
  RunFile const back = read_run(written());
  EXPECT_TRUE(same(trace.coupling, back.trace.coupling));
  EXPECT_TRUE(same(trace.total, back.trace.total));
  EXPECT_TRUE(same(noise, *back.noise));
  EXPECT_TRUE(back.complete);
  RunContent const was = content(trace, &noise);
  EXPECT_EQ(back.about.files, was.files);
  EXPECT_EQ(back.about.main_file, "arm.yaml");
  EXPECT_EQ(back.about.overrides, was.overrides);
  EXPECT_EQ(back.about.resolved, was.resolved);
  EXPECT_EQ(back.about.model_hash, was.model_hash);
  EXPECT_EQ(back.about.interferometer, was.interferometer);
  EXPECT_EQ(back.about.provenance.build_flags, "g++ 12 -O3");
  EXPECT_EQ(back.about.timing, was.timing);
  EXPECT_EQ(back.about.warnings, was.warnings);
  EXPECT_EQ(back.trace.warnings, trace.warnings);
  EXPECT_EQ(back.trace.seconds, 12.5);
  ASSERT_TRUE(back.about.seam);
  EXPECT_EQ(std::memcmp(back.about.seam.get(), was.seam.get(), sizeof(SeamCheck)), 0);  // numbers without gaps
}

TEST_F(ReportRunFile, KeepsTheFieldOfARing) {
  RunFile const file = read_run(written());
  ASSERT_TRUE(file.about.ring);
  wave::RingRecord const &back = *file.about.ring, was = ring_record();
  EXPECT_EQ(back.beam, was.beam);
  EXPECT_EQ(back.eigenvalue, was.eigenvalue);
  EXPECT_EQ(back.reverse_eigenvalue, was.reverse_eigenvalue);
  EXPECT_TRUE(back.grid == was.grid);
  EXPECT_EQ(back.length, 33);
  ASSERT_EQ(back.surfaces.size(), 2u);
  EXPECT_EQ(back.surfaces[0].body, "pipe");
  EXPECT_TRUE(back.surfaces[1].mirror && !back.surfaces[0].mirror);
  EXPECT_EQ(back.surfaces[1].reference.y, 5);
  EXPECT_EQ(back.surfaces[0].widening, was.surfaces[0].widening);
  EXPECT_EQ(back.surfaces[1].levers.rotation[2], was.surfaces[1].levers.rotation[2]);
  EXPECT_NE(back.surfaces[1].levers.rotation[2], was.surfaces[0].levers.rotation[2]);
  ASSERT_EQ(back.modes.size(), 1u);
  EXPECT_EQ(back.modes[0].laguerre.two, -1);
  ASSERT_TRUE(back.grid_check);
  EXPECT_EQ(back.grid_check->points, 6);
  EXPECT_EQ(back.grid_check->losses.taken, was.grid_check->losses.taken);
  EXPECT_EQ(back.grid_check->losses.beyond_band, 4e-12);
  EXPECT_EQ(back.grid_check->phase, 5e-6);
  EXPECT_EQ(back.grid_check->edges, 0.01);
  EXPECT_EQ(back.grid_check->mirrors, 0.02);
}

TEST_F(ReportRunFile, KeepsTheFieldOfACavity) {
  RunFile const file = read_run(written());
  ASSERT_TRUE(file.about.waves);
  wave::WaveRecord const &back = *file.about.waves, was = wave_record();
  EXPECT_EQ(back.key, was.key);
  EXPECT_EQ(back.eigenvalue, was.eigenvalue);
  EXPECT_TRUE(std::isnan(back.perfect_loss));
  EXPECT_TRUE(back.grid == was.grid);
  ASSERT_EQ(back.heights.size(), 2u);
  for (std::size_t i : {0, 1}) EXPECT_EQ(back.heights[0].mirrors[i].figure, was.heights[0].mirrors[i].figure);
  EXPECT_NE(back.heights[0].mirrors[0].figure, was.heights[0].mirrors[1].figure);
  EXPECT_EQ(back.heights[0].mirrors[0].whole.rotation[2], was.heights[0].mirrors[0].whole.rotation[2]);
  EXPECT_EQ(back.heights[0].mirrors[1].whole.displacement[0], 0.0);
  EXPECT_EQ(back.heights[0].at_mirrors, was.heights[0].at_mirrors);
  EXPECT_EQ(back.heights[0].on_baffles, was.heights[0].on_baffles);
  EXPECT_EQ(back.heights[1].round_trips, 10u);
  EXPECT_DOUBLE_EQ(back.loss(), 3e-7);
  ASSERT_EQ(back.modes.size(), 2u);
  EXPECT_EQ(back.modes[1].hermite.one, 1);
  EXPECT_EQ(back.modes[1].laguerre.two, -1);
  EXPECT_EQ(back.modes[1].alike, 2);
  EXPECT_EQ(back.mirrors[0].light.expected, was.mirrors[0].light.expected);
  EXPECT_EQ(back.modes[1].phase, 0.25);
  ASSERT_EQ(back.rims.size(), 2u);
  EXPECT_EQ(back.rims[0].centre.y, 1e-3);
  EXPECT_EQ(back.rims[0].draws[0].clipped, was.rims[0].draws[0].clipped);
  EXPECT_EQ(back.rims[0].draws[1].heights, 1u);
  EXPECT_EQ(back.rims[1].speckle.longitudinal, 3e-20);
  ASSERT_EQ(back.rims[0].draws.size(), 2u);
  EXPECT_EQ(back.rims[1].draws.size(), 0u);
  EXPECT_EQ(back.rims[0].draws[1].response.levers.rotation[2], was.rims[0].draws[1].response.levers.rotation[2]);
  EXPECT_NE(back.rims[0].draws[1].response.levers.rotation[2], was.rims[0].draws[0].response.levers.rotation[2]);
  EXPECT_EQ(back.device, "a GPU");
  ASSERT_EQ(back.diodes.size(), 2u);
  EXPECT_EQ(back.diodes[0].name, "d_1");
  EXPECT_EQ(back.diodes[0].rim, 1u);
  EXPECT_TRUE(back.diodes[0].towards_mirror1 && !back.diodes[1].towards_mirror1);
  EXPECT_EQ(back.diodes[0].centre, was.diodes[0].centre);
  EXPECT_EQ(back.diodes[0].power, 2e-9);
  EXPECT_TRUE(std::isnan(back.diodes[1].power));
  EXPECT_EQ(back.diodes[1].spread, 2e-9);
  EXPECT_NE(back.diodes[1].mean, back.diodes[0].mean);
  EXPECT_TRUE(back.irradiance.towards_mirror2[0].mean.empty());
  EXPECT_EQ(back.irradiance.towards_mirror1[0].mean, was.irradiance.towards_mirror1[0].mean);
  EXPECT_EQ(back.irradiance.towards_mirror2[3].square, was.irradiance.towards_mirror2[3].square);
  EXPECT_EQ(back.irradiance.towards_mirror2[3].step, 0.5);
  ASSERT_TRUE(back.grid_check && back.bands);
  EXPECT_EQ(back.grid_check->points, 6);
  EXPECT_EQ(back.grid_check->ledger.towards_mirror1, was.grid_check->ledger.towards_mirror1);
  EXPECT_EQ(back.grid_check->ledger.beyond_band, -7e-13);
  EXPECT_TRUE(std::isnan(back.grid_check->along));
  ASSERT_EQ(back.bands->bands.size(), 2u);
  EXPECT_EQ(back.bands->bands[1].scattered[1], 4e-8);
  EXPECT_EQ(back.bands->bands[0].loss, -1e-9);
  EXPECT_EQ(back.bands->beyond, 6e-8);
  ASSERT_EQ(back.fields.size(), 2u);
  EXPECT_EQ(back.fields[1].values, was.fields[1].values);
  EXPECT_EQ(back.warnings, was.warnings);
}

// The comparison itself sees one changed last bit, and -0 where 0 was.
TEST_F(ReportRunFile, ComparisonSeesOneBit) {
  CouplingTable other = trace.coupling;
  double& phase_sensitivity = other.classes[2].records[7].phase_sensitivities[1].d[5];
  phase_sensitivity = -phase_sensitivity;
  EXPECT_FALSE(same(trace.coupling, other));
  CouplingTable kinds = trace.coupling;
  kinds.classes[2].kind = ClassKind::ghost;
  EXPECT_FALSE(same(trace.coupling, kinds));
  CouplingTable turned = trace.coupling;
  turned.classes[2].records[7].field[1] = {0, 1e-9};
  EXPECT_FALSE(same(trace.coupling, turned));
  CouplingTable others = trace.coupling;
  others.classes[6].records[1].member = no_member;
  EXPECT_FALSE(same(trace.coupling, others));
  CouplingTable lit = trace.coupling;
  lit.classes[2].records[7].beam = beam_of_port;
  EXPECT_FALSE(same(trace.coupling, lit));
  NoiseBudget louder = noise;
  louder.routes[3].sigma[9] = std::nextafter(louder.routes[3].sigma[9], 1);
  EXPECT_FALSE(same(noise, louder));
}

// A file of schema 1: the same values under the names of that time.
hdf5::Contents of_schema_1(hdf5::Contents const& contents, std::string const& ledger = "ledger") {
  std::pair<std::string, std::string> const names[] = {
      {"/energy_balance", "/" + ledger}, {"/phase_sensitivities", "/levers"}, {"/phase_sensitivity", "/lever"}};
  hdf5::Contents out;
  for (auto const& [path, object] : contents) {
    std::string name = path;
    for (auto const& [now, then] : names)
      if (auto const at = path.find(now); at != path.npos) {
        name.replace(at, now.size(), then);
        break;
      }
    out[name] = object;
  }
  auto& about = out.at("/").attributes;
  auto checks = about.extract("good_checks");
  checks.key() = "good_looks";
  about.insert(std::move(checks));
  about.at("schema").bytes[0] = 1;
  return out;
}

TEST_F(ReportRunFile, ReadsSchema1) {
  std::string const file = written();
  std::ifstream in(file, std::ios::binary);
  hdf5::Contents const contents = hdf5::contents_of(unsealed({std::istreambuf_iterator<char>(in), {}}, file));
  RunFile const now = run_of(contents, file), then = run_of(of_schema_1(contents), file);
  EXPECT_TRUE(same(now.trace.coupling, then.trace.coupling));
  EXPECT_TRUE(same(now.trace.total, then.trace.total));
  EXPECT_TRUE(same(*now.noise, *then.noise));
  EXPECT_EQ(now.trace.good_checks, then.trace.good_checks);
  EXPECT_THROW((void)run_of(of_schema_1(contents, "cellar"), file), InputError);  // negative control: no such name
}

// Before schema 2.4 files had no delays: their moments are not known, and nothing else differs.
TEST_F(ReportRunFile, ReadsFilesWithoutDelays) {
  std::string const file = written();
  std::ifstream in(file, std::ios::binary);
  hdf5::Contents contents = hdf5::contents_of(unsealed({std::istreambuf_iterator<char>(in), {}}, file));
  ASSERT_EQ(contents.erase("/records/phase_sensitivity_delay"), 1u);
  RunFile then = run_of(contents, file);
  EXPECT_FALSE(same(trace.coupling, then.trace.coupling));
  std::size_t unknown = 0;
  for (std::size_t c = 0; c < then.trace.coupling.classes.size(); ++c)
    for (std::size_t r = 0; r < then.trace.coupling.classes[c].records.size(); ++r) {
      auto& list = then.trace.coupling.classes[c].records[r].phase_sensitivities;
      for (std::size_t i = 0; i < list.size(); ++i) {
        unknown += std::isnan(list[i].moment[0]) && std::isnan(list[i].moment[5]);
        std::ranges::copy(trace.coupling.classes[c].records[r].phase_sensitivities[i].moment, list[i].moment);
      }
    }
  EXPECT_GT(unknown, 10u);
  EXPECT_TRUE(same(trace.coupling, then.trace.coupling));
}

TEST_F(ReportRunFile, ResumesToTheSameBits) {
  RunFile half;
  TraceResult first;
  for (std::uint64_t i = 0; i < 20; ++i) first.tree.add(0, i, block(i));
  first.total = first.tree.total();
  first.coupling = coupling_table();
  first.stopped = Stopped::by_time;
  write_run(folder / "half.h5", content(first, nullptr));
  half = read_run(folder / "half.h5");
  EXPECT_FALSE(half.complete);
  EXPECT_TRUE(half.trace.checkpointed());
  EXPECT_FALSE(half.noise.has_value());
  EXPECT_TRUE(same(first.tree, half.trace.tree));
  for (std::uint64_t i = 20; i < 37; ++i) half.trace.tree.add(0, i, block(i));
  EXPECT_TRUE(same(half.trace.tree, trace.tree));
  EXPECT_TRUE(same(half.trace.tree.total(), trace.total));
}

TEST_F(ReportRunFile, ResumingWithASkippedBlockDiffers) {
  SumTree tree;
  for (std::uint64_t i = 0; i < 36; ++i) tree.add(0, i, block(i));
  EXPECT_FALSE(same(tree.total(), trace.total));
}

TEST_F(ReportRunFile, CanBeWrittenAgainFromWhatWasRead) {
  RunFile const back = read_run(written());
  write_run(folder / "again.h5", back.content());
  EXPECT_EQ(read_file(folder / "run.h5"), read_file(folder / "again.h5"));
}

// Files before schema 2.1 do not state the routes of the paths in rows `other`; a route that is not listed is an error.
TEST_F(ReportRunFile, ReadsSchema2_0) {
  std::string const file = written();
  hdf5::Contents contents = hdf5::contents_of(unsealed(read_file(file), file));
  CouplingClass const now = run_of(contents, file).trace.coupling.classes[6];
  EXPECT_EQ(now.members.size(), 2u);
  EXPECT_EQ(now.records[1].member, 1u);
  hdf5::Contents unlisted = contents;
  std::erase_if(unlisted, [](auto const& object) { return object.first.starts_with("/members"); });
  EXPECT_THAT(message_of([&] { (void)run_of(unlisted, file); }), HasSubstr("a path of a route that is not listed"));
  unlisted.erase("/records/member");
  CouplingClass const then = run_of(unlisted, file).trace.coupling.classes[6];
  EXPECT_TRUE(then.members.empty());
  EXPECT_EQ(then.records[1].member, no_member);
}

// Files before schema 2.4 do not state the beam that the light of a path leaves.
TEST_F(ReportRunFile, ReadsSchema2_3) {
  std::string const file = written();
  hdf5::Contents contents = hdf5::contents_of(unsealed(read_file(file), file));
  EXPECT_EQ(run_of(contents, file).trace.coupling.classes[2].records[7].beam, 3u);
  contents.erase("/records/beam");
  EXPECT_EQ(run_of(contents, file).trace.coupling.classes[2].records[7].beam, beam_of_port);
}

// Files without the columns of schema 1.2: what is not known is not judged.
TEST_F(ReportRunFile, ReadsFilesOfSchema1_1) {
  std::string const file = folder / "old.h5";
  std::ofstream(file, std::ios::binary) << unsealed(read_file(written()), "run.h5");
  {
    H5::H5File old(file, H5F_ACC_RDWR);
    for (char const* path :
         {"/nodes/class_off_list", "/nodes/class_first_sum", "/nodes/class_largest_offset", "/nodes/class_largest",
          "/classes/tail_slope", "/classes/halves", "/classes/kind", "/classes/statement"})
      old.unlink(path);
  }
  std::ofstream(folder / "sealed.h5", std::ios::binary) << sealed(read_file(file));
  RunFile const back = read_run(folder / "sealed.h5");
  EXPECT_FALSE(same(trace.total, back.trace.total));
  Moments const& m = back.trace.total.classes.at(1000).moments;
  EXPECT_EQ(m.sum, trace.total.classes.at(1000).moments.sum);
  Estimate const e = estimate(m, back.trace.total.histories, back.trace.total.blocks);
  EXPECT_TRUE(std::isnan(e.tail_slope));
  EXPECT_TRUE(std::isnan(e.halves));
  EXPECT_TRUE(std::isnan(back.trace.coupling.classes[0].coupling.tail_slope));
  EXPECT_EQ(back.trace.coupling.classes[0].kind, ClassKind::scattered);
}

TEST_F(ReportRunFile, HoldsAnEmptyResult) {
  TraceResult nothing;
  NoiseBudget quiet;
  quiet.grid.edges = {10, 20};
  quiet.total.name = "total";
  quiet.total.asd = quiet.total.sigma = quiet.total.phase_asd = quiet.total.amplitude_asd = {0};
  RunContent c = content(nothing, &quiet);
  c.files.clear();
  c.overrides.clear();
  c.warnings.clear();
  c.importance = {};
  c.projection.reset();
  write_run(folder / "empty.h5", c);
  RunFile const back = read_run(folder / "empty.h5");
  EXPECT_TRUE(back.trace.coupling.classes.empty());
  EXPECT_TRUE(back.about.files.empty());
  EXPECT_EQ(back.noise->total.asd.size(), 1u);
}

TEST_F(ReportRunFile, EqualContentGivesEqualBytesAndHash) {
  std::string const one = written("one.h5"), two = written("two.h5");
  EXPECT_EQ(read_file(one), read_file(two));
  EXPECT_EQ(data_hash(one), data_hash(two));
}

TEST_F(ReportRunFile, HashIgnoresOnlyTimeAndTiming) {
  std::string const before = data_hash(written());
  RunContent later = content(trace, &noise);
  later.provenance.created = "2031-01-01T00:00:00Z";
  later.timing["scene"] = 99;
  later.timing["extra"] = 1;
  write_run(folder / "later.h5", later);
  EXPECT_EQ(data_hash(folder / "later.h5"), before);
  EXPECT_NE(read_file(folder / "later.h5"), read_file(folder / "run.h5"));
}

TEST_F(ReportRunFile, HashSeesOneChangedBitOrName) {
  std::string const before = data_hash(written());
  std::set<std::string> hashes = {before};
  double& weight = trace.coupling.classes[1].records[2].weight;
  weight = std::nextafter(weight, 1);
  hashes.insert(data_hash(written()));
  trace.coupling.groups[3] = "tubes";
  hashes.insert(data_hash(written()));
  noise.margin = 0.2;
  hashes.insert(data_hash(written()));
  EXPECT_EQ(hashes.size(), 4u);
}

TEST_F(ReportRunFile, NoObjectHasATimeStamp) {
  write_file(folder / "plain.h5", unsealed(read_file(written()), "run.h5"));
  H5::H5File const in(folder / "plain.h5", H5F_ACC_RDONLY);
  for (char const* path :
       {"/", "/classes", "/classes/mean", "/noise/total", "/records/phase_sensitivity", "/input/files/0"}) {
    H5O_info_t info = {};
    ASSERT_GE(H5Oget_info_by_name2(in.getId(), path, &info, H5O_INFO_TIME, H5P_DEFAULT), 0) << path;
    EXPECT_EQ(info.mtime, 0) << path;
    EXPECT_EQ(info.ctime, 0) << path;
  }
}

TEST_F(ReportRunFile, OtherFilesAreErrors) {
  write_file(folder / "text.h5", "hello");
  write_file(folder / "none.h5", "");
  { H5::H5File const other(folder / "other.h5", H5F_ACC_TRUNC); }
  EXPECT_THAT(message_of([&] { read_run(folder / "text.h5"); }), HasSubstr("is not a straytrace run file"));
  EXPECT_THAT(message_of([&] { read_run(folder / "none.h5"); }), HasSubstr("the file is empty"));
  EXPECT_THAT(message_of([&] { read_run(folder / "other.h5"); }), HasSubstr("HDF5 file of another program"));
  EXPECT_THAT(message_of([&] { read_run(folder / "missing.h5"); }), HasSubstr("there is no such file"));
  EXPECT_THAT(message_of([&] { read_run(folder / "."); }), HasSubstr("it is not a regular file"));
}

std::string made(std::string const& kind, std::uint64_t major) {
  hdf5::Writer out;
  out.attribute("/", "file_type", kind);
  out.attribute("/", "schema", std::vector<std::uint64_t>{major, 0});
  out.attribute("/", "program", "straytrace");
  out.attribute("/", "version", "9.1");
  return sealed(out.bytes());
}

TEST_F(ReportRunFile, OtherKindsAndNewerSchemasAreErrors) {
  write_file(folder / "kind.h5", made("straytrace-scan", 1));
  write_file(folder / "new.h5", made("straytrace-run", 3));
  write_file(folder / "bare.h5", made("straytrace-run", 1));
  EXPECT_THAT(message_of([&] { read_run(folder / "kind.h5"); }), HasSubstr("its type is 'straytrace-scan'"));
  EXPECT_THAT(message_of([&] { read_run(folder / "new.h5"); }),
              HasSubstr("format 3.0 and was written by straytrace 9.1"));
  EXPECT_THAT(message_of([&] { read_run(folder / "bare.h5"); }), HasSubstr("is damaged"));
}

// Every group and dataset can be read; what cannot be opened as HDF5 at all is a sentence, not a crash.
TEST_F(ReportRunFile, ReadsVerifiedBytesInThisProcess) {
  write_file(folder / "no_hdf5.h5", sealed("no HDF5 at all"));
  EXPECT_THAT(message_of([&] { read_run(folder / "no_hdf5.h5"); }), HasSubstr("it cannot be opened"));
  std::string damaged = read_file(written());
  damaged.back() = char(damaged.back() + 1);
  write_file(folder / "damaged.h5", damaged);
  EXPECT_THAT(message_of([&] { read_run(folder / "damaged.h5"); }), HasSubstr("does not match its checksum"));
}

TEST_F(ReportRunFile, HoldsWhatProjectionNeeds) {
  ProjectionInputs const wrote = projection_inputs(trace.coupling);
  std::optional<ProjectionInputs> const read = read_run(written()).about.projection;
  ASSERT_TRUE(read);
  EXPECT_EQ(read->bodies, wrote.bodies);
  EXPECT_EQ(read->meets_light, wrote.meets_light);
  EXPECT_EQ(read->wavelength, wrote.wavelength);
  ASSERT_EQ(read->ports.size(), wrote.ports.size());
  TracedPort const &a = read->ports.front(), &b = wrote.ports.front();
  EXPECT_EQ(std::tie(a.name, a.injection_point, a.power, a.cavity_length, a.through_mirror),
            std::tie(b.name, b.injection_point, b.power, b.cavity_length, b.through_mirror));
  ASSERT_EQ(read->materials.size(), wrote.materials.size());
  MaterialSpread const &steel = read->materials.front(), &same = wrote.materials.front();
  EXPECT_EQ(std::tie(steel.name, steel.status, steel.low, steel.high, steel.factor, steel.of_reflection, steel.groups),
            std::tie(same.name, same.status, same.low, same.high, same.factor, same.of_reflection, same.groups));
  EXPECT_TRUE(read->materials.back().groups.empty());
  ASSERT_EQ(read->optics.size(), 2u);
  DrawnOptic const &optic = read->optics.front(), &drawn = wrote.optics.front();
  EXPECT_EQ(std::tie(optic.name, optic.body, optic.vertex.z, optic.axis.y, optic.curvature),
            std::tie(drawn.name, drawn.body, drawn.vertex.z, drawn.axis.y, drawn.curvature));
  EXPECT_EQ(read->scattered, wrote.scattered);
  EXPECT_EQ(read->notes, wrote.notes);
  EXPECT_EQ(read->limits, wrote.limits);
  EXPECT_EQ(read->warnings, wrote.warnings);
  EXPECT_EQ(read->warnings_json, wrote.warnings_json);
}

TEST_F(ReportRunFile, TruncatedAndChangedFilesAreErrors) {
  std::string const good = read_file(written());
  for (std::size_t const length :
       {std::size_t{10}, std::size_t{100}, std::size_t{512}, good.size() / 2, good.size() - 1}) {
    write_file(folder / "cut.h5", good.substr(0, length));
    EXPECT_THAT(message_of([&] { read_run(folder / "cut.h5"); }),
                HasSubstr(length > 21 ? "damaged" : "not a straytrace"));
  }
  for (std::size_t place = 3; place < good.size(); place += good.size() / 23) {
    std::string bad = good;
    bad[place] = char(bad[place] ^ 4);
    write_file(folder / "bad.h5", bad);
    std::string const message = message_of([&] { read_run(folder / "bad.h5"); });
    // Behind the line of the checksum the first block is empty and has no meaning.
    bool const padding = place > 110 && place < 512;
    EXPECT_EQ(message == "no error", padding) << place << message;
  }
}

TEST_F(ReportRunFile, LeavesNoFileWhenItCannotWrite) {
  EXPECT_THAT(message_of([&] { write_run(folder / "missing/run.h5", content(trace, &noise)); }),
              HasSubstr("cannot write"));
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THAT(message_of([&] { write_run(folder / "taken", content(trace, &noise)); }), HasSubstr("cannot write"));
  EXPECT_EQ(folder.files(), 1u);
}

// A full disk, played by a limit on the size of files: the old file stays, no part of the new one.
TEST_F(ReportRunFile, KeepsTheOldFileWhenTheDiskIsFull) {
  std::string const old = read_file(written());
  rlimit before = {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit const small = {4096, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  std::string const message = message_of([&] { write_run(folder / "run.h5", content(trace, nullptr)); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, HasSubstr("cannot write"));
  EXPECT_EQ(read_file(folder / "run.h5"), old);
  EXPECT_EQ(folder.files(), 1u);
}

TEST_F(ReportRunFile, HoldsNoPathsOfThisMachine) {
  std::string const bytes = read_file(written());
  EXPECT_EQ(bytes.find(folder / ""), std::string::npos);
  EXPECT_EQ(bytes.find("/tmp"), std::string::npos);
  EXPECT_EQ(bytes.find("/home"), std::string::npos);
}

TEST(ReportHash, IsThePublishedOne) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-2
  EXPECT_NE(sha256("abd"), sha256("abc"));
}

TEST(ReportHash, ModelHashKeepsTextsApart) {
  EXPECT_NE(model_hash(std::vector<std::string>{"ab", "c"}), model_hash(std::vector<std::string>{"a", "bc"}));
  EXPECT_EQ(model_hash(std::vector<std::string>{"ab", "c"}), model_hash(std::vector<std::string>{"ab", "c"}));
}

}  // namespace
}  // namespace straytrace::test
