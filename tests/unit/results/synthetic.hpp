// SPDX-License-Identifier: BSD-3-Clause
// A made-up run with plausible numbers: five resolved routes, one unresolved, one `other`, 37 blocks in three nodes.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <unistd.h>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "results/run_file/run_file.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/ring/ring_record.hpp"

namespace straytrace::test {

// A separate folder, removed at the end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "straytrace-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Folder(Folder const&) = delete;
  Folder& operator=(Folder const&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(std::string const& file) const { return (path_ / file).string(); }
  std::size_t files() const {
    return std::size_t(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

// A run file of these bytes of HDF5.
inline std::string sealed(std::string const& hdf5_image) { return results::checksum_header(hdf5_image) + hdf5_image; }

constexpr std::size_t route_count = 7, bin_count = 120;

// A number in (0, 1) that is different for each argument.
inline double spread(std::size_t i) { return std::fmod(0.5 + 0.6180339887498949 * double(i + 1), 1.0); }

inline BlockSums block(std::uint64_t index) {
  BlockSums b;
  b.histories = largest_block;
  b.blocks = 1;
  b.bounces = 3 * largest_block + index;
  b.rays = 9 * largest_block;
  b.arrived.resize(4);
  b.absorbed.resize(5);
  constexpr std::size_t bright = 8;  // histories that carry the power of all
  constexpr double power = double(largest_block) / bright;
  for (std::size_t k = 0; k < bright; ++k) {
    std::uint64_t const history = index * largest_block + k;
    double const x = spread(history);
    b.emitted.add(power, history);
    double const shares[] = {0.61, 0.35 + 0.02 * (x - 0.5), 0.04 - 0.02 * (x - 0.5)};
    for (std::size_t f = 0; f < 3; ++f) b.energy_balance[f].add(power * shares[f], history);
    for (std::size_t g = 0; g < 3; ++g) b.arrived[g].add(power * 0.1 * double(g + 1) * x, history);
    for (std::size_t g : {0, 1, 4}) b.absorbed[g].add(power * 0.61 / 3, history);
  }
  b.emitted.close_block();
  for (Moments& m : b.energy_balance) m.close_block();
  for (Moments& m : b.arrived) m.close_block();
  for (Moments& m : b.absorbed) m.close_block();
  for (std::size_t c = 0; c < route_count; ++c) {
    ClassSums& sums = b.classes[1000 + c];
    std::uint64_t const history = index * largest_block + c;
    double const coupling = 1e-20 * spread(history + c);
    sums.moments.add_score(coupling, history);
    sums.moments.close_block();
    sums.off_list = 0.1 * coupling;
    sums.replica_sum[index % replica_count] += coupling;
    sums.kept.push_back({history, 2, 1, coupling, coupling / spread(history + 7)});
    sums.phase_sensitivities.add(index % replica_count, coupling, {{BodyId{0}, {1, 2, spread(c)}}, {BodyId{1}, {4}}});
  }
  return b;
}

inline PathRecord record(std::size_t c, std::size_t k) {
  PathRecord r;
  r.history = 100 * c + k;
  r.event = std::uint32_t(k % 3);
  r.connection = 1;
  r.coupling = 1e-20 * spread(k);
  r.weight = 1e-22 * (1 + spread(k + c));
  r.path_length = 200.0 * double(c + 1) + 3 * spread(k);
  r.phase_sensitivities.push_back({{0}, {1e5 * spread(k), 2e5 * spread(k + 1), 1.18e7, 0, 3, 4}, {1, 2, spread(k)}});
  if (c % 2 == 0) r.phase_sensitivities.push_back({{1}, {1e4, 2e4, -1.18e7 * spread(k), 1, 2, 0}});
  if (k % 2 == 0) r.amplitude_levers.push_back({{1}, {1, 0, 0, 0, -4359 * spread(k), 0}});
  return r;
}

inline CouplingTable coupling_table() {
  CouplingTable t;
  t.groups = {"ITM", "baffles", "ETM", "tube"};
  t.bodies = {"tube", "ITM"};
  t.ports = {"arm"};
  t.histories = 37 * largest_block;
  t.seed = 7;
  t.wavelength = 1064e-9;
  t.replica_histories.fill(4736);
  for (std::size_t c = 0; c < route_count; ++c) {
    CouplingClass k;
    k.hash = 1000 + c;
    k.port = {0};
    if (c + 1 < route_count)
      k.steps = {{{0}, Event::scatter},
                 {{std::uint32_t(1 + c % 3)}, c % 2 ? Event::reflect : Event::scatter},
                 {{std::uint32_t(2 * (c / 3))}, Event::scatter}};
    double const mean = 1.2345e-20 * std::pow(0.35, double(c));
    k.coupling = {mean, mean * 0.02 * double(c + 1), 0.01, 0.004, 1.2e4, 54321 - c, true, ""};
    k.reverse = c % 2 ? 2 : 1;
    k.by_reverse = c == 3;
    k.replica_sum.fill(mean * 4736);
    for (std::size_t r = 0; r < 20; ++r) k.records.push_back(record(c, r));
    if (c != 1)
      k.phase_sensitivities = {{std::uint32_t(c), {0}, {0}, {spread(c), 2}}, {std::uint32_t(c + 1), {0}, {1}, {3, -4}}};
    t.classes.push_back(k);
  }
  t.classes[6].folded_routes = 9;
  t.classes[6].folded = {{77, {}, 1e-23, 1e-25, true, "more vertices than 'route_vertices' names"},
                         {78, t.classes[2].steps, 4e-24, 3e-24, false, "only 14 histories have scored"}};
  t.classes[6].members = {{t.classes[2].steps}, {}};
  for (std::size_t r = 0; r < t.classes[6].records.size(); ++r) t.classes[6].records[r].member = std::uint32_t(r % 2);
  t.classes[2].records[7].beam = 3;
  t.classes[4].coupling.trusted = false;
  t.classes[4].coupling.why_not = "one history carries 31 % of the sum";
  return t;
}

// Fit of the Advanced Virgo design, docs/theory/environment.md, eq. 12.1.
inline double design_asd(double hz) {
  double const x = std::log(hz / 300);
  return 1.259e-24 *
         (0.07 * std::exp(-0.142 - 1.437 * x + 0.407 * x * x) + 3.1 * std::exp(-0.466 - 1.043 * x - 0.548 * x * x) +
          0.4 * std::exp(-0.304 + 2.896 * x - 0.293 * x * x) + 0.09 * std::exp(1.466 + 3.722 * x - 0.984 * x * x));
}

inline NoiseTrace noise_trace(std::string const& name, FrequencyGrid const& grid, double size, double slope,
                              double error) {
  NoiseTrace t;
  t.name = name;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double const f = std::sqrt(grid.edges[i] * grid.edges[i + 1]);
    double const h = size * std::pow(f / 10, slope) * (1 + 2 / (1 + std::pow((f - 35 * (1 - slope / 9)) / 2, 2)));
    t.asd.push_back(h);
    t.sigma.push_back(error * h);
    t.phase_asd.push_back(0.98 * h);
    t.amplitude_asd.push_back(std::sqrt(1 - 0.98 * 0.98) * h);
  }
  t.mean_square_phase = 0.2 + 0.1 * -slope;
  return t;
}

inline NoiseBudget noise_budget(CouplingTable const& table, double size = 6e-24) {
  NoiseBudget b;
  for (std::size_t i = 0; i <= bin_count; ++i) b.grid.edges.push_back(5 * std::pow(200.0, double(i) / bin_count));
  b.total = noise_trace("total", b.grid, 0, -2, 0);
  for (std::size_t c = 0; c < table.classes.size(); ++c) {
    NoiseTrace t = noise_trace(route_name(table, table.classes[c]), b.grid, size * std::pow(0.6, double(c)),
                               -2 - 0.2 * double(c), 0.01 * double(c + 1));
    t.hash = table.classes[c].hash;
    t.resolved = table.classes[c].coupling.trusted;
    t.why_not = table.classes[c].coupling.why_not;
    if (c == 1) t.mean_square_phase = 9;
    for (std::size_t i = 0; i < bin_count; ++i) {
      if (!t.resolved) t.sigma[i] = 0.5 * t.asd[i];  // a hint, with an error as large
      b.total.sigma[i] =
          std::hypot(b.total.asd[i] * b.total.sigma[i], t.asd[i] * t.sigma[i]) / std::hypot(b.total.asd[i], t.asd[i]);
      b.total.asd[i] = std::hypot(b.total.asd[i], t.asd[i]);
      b.total.phase_asd[i] = 0.98 * b.total.asd[i];
      b.total.amplitude_asd[i] = std::sqrt(1 - 0.98 * 0.98) * b.total.asd[i];
    }
    b.routes.push_back(t);
  }
  b.total.resolved = false;
  b.unresolved = {b.routes[4].name + ": " + b.routes[4].why_not};
  b.unresolved_hint = 0.013;
  DesignCurve design{"adv-lal", {}};
  for (std::size_t i = 0; i < bin_count; ++i)
    design.asd.push_back(design_asd(std::sqrt(b.grid.edges[i] * b.grid.edges[i + 1])));
  b.design.push_back(design);
  for (std::size_t i = 0; i < bin_count; ++i) {
    double const h = b.total.asd[i];
    b.bands.input_low.push_back(0.5 * h);
    b.bands.input_high.push_back(2 * h);
    b.bands.speckle_05.push_back(0.2265 * h);
    b.bands.speckle_50.push_back(0.8326 * h);
    b.bands.speckle_95.push_back(1.7308 * h);
    b.bands.coherent.push_back(1.9 * h);
    b.total.linear_share.push_back(i < bin_count / 2 ? 0.1 : 0.9);
    b.routes[0].linear_share.push_back(i < bin_count / 2 ? 0.1 : 0.9);
    for (std::size_t r = 1; r < b.routes.size(); ++r) b.routes[r].linear_share.push_back(r == 1 ? 0.05 : 0.97);
    for (NoiseTrace& t : b.routes) {
      t.input_low.push_back(0.5 * t.asd[i]);
      t.input_high.push_back(2 * t.asd[i]);
    }
  }
  b.scanned_body = "tube";
  for (double const factor : {0.5, 1.3229}) b.positions.push_back({factor, b.total.asd});
  b.bands.sources = {{"material steel", "bracket: x 0.25 to 4 (assumed)", 0.5, 2, 0.8}};
  b.bands.taken_as_exact = {"motion of tube"};
  b.seconds = 0.5;
  return b;
}

inline TraceResult trace_result() {
  TraceResult t;
  for (std::uint64_t i = 0; i < 37; ++i) t.tree.add(0, i, block(i));
  t.total = t.tree.total();
  t.coupling = coupling_table();
  t.seconds = 12.5;
  t.warnings = {"4 % of port arm comes from 'flange_17'"};
  return t;
}

inline ProjectionInputs projection_inputs(CouplingTable const& table) {
  ProjectionInputs p;
  p.bodies = table.bodies;
  for (std::size_t i = 0; i < table.bodies.size(); ++i) p.meets_light.push_back(i == 0);
  p.wavelength = table.wavelength;
  for (std::string const& name : table.ports)
    p.ports.push_back({name, InjectionPoint::end_mirror, 4e5, 2999.8, p.ports.empty(), "BS.3.out", "ITMx.front.out",
                       p.ports.empty(), !p.ports.empty(), 0.0073});
  p.optics = {{"ITM", "itm", {1, 2, 3}, {0, 0.6, 0.8}, 1 / 1420.0}, {"BS", "", {0, 0, -6}, {0, 0, 1}}};
  p.materials = {{"steel", "assumed", 0.5, 2, 1.3, false, {{0}, {1}}}, {"mirror", "", 1, 1, 1, true, {}}};
  p.scattered = {0.02, 1e-5};
  p.notes = {"gap 2 mm assumed"};
  p.limits = {"ghost beams are not counted"};
  p.warnings = "warning: steel: measured 10 to 70 deg\n";
  p.warnings_json = "[]\n";
  return p;
}

inline wave::RimResponse rim_response(double size) {
  wave::RimResponse r{{}, {size, -3 * size}};
  for (int i = 0; i < 3; ++i) {
    r.levers.displacement[i] = {size * spread(std::size_t(i)), -size};
    r.levers.rotation[i] = {-size, size * spread(std::size_t(i) + 3)};
  }
  return r;
}

// Two rims, the first within the crossover angle, on a grid of 4 x 4 points.
inline wave::WaveRecord wave_record() {
  wave::WaveRecord w;
  w.key = "0123abcd";
  w.beam = "arm";
  w.power = 3e6;
  w.wavelength = 1064e-9;
  w.length = 1e4;
  w.grid = {4, 2};
  w.crossover = 1e-4;
  w.eigenvalue = {0.9, -0.4};
  wave::RimLevers const whole = rim_response(2e-9).levers;
  w.heights = {{{1e-10, 2e-10},
                2e-7,
                1e-7,
                12,
                {3e-8, 4e-8},
                {6e-9, 4e-9},
                1e-9,
                {{{whole, {{{1, 2}, {3, -4}, {5, 6}}}}, {{}, {{{-1, 2}, {-3, 4}, {-5, 6}}}}}}},
               {{3e-10, 4e-10}, 4e-7, 1e-6, 10, {}, {}, 0, {}}};
  w.perfect_loss = not_a_number;
  w.beyond_band = 1e-9;
  w.mirrors = {{{"ITM", 0.31, 2e-4, 0.12, 1e-7, 1e-10, 3e-8, {{1e-3, 2e-3}, {3e-3, -4e-3}}},
                {"ETM", 0.31, 2e-4, 0.12, 2e-7, 2e-10, 4e-8, {}}}};
  w.modes = {{0, {0, 0, 1}, {0, 0, 1}, 1, 1e-7, 0, 1e-8, 1}, {1, {1, 0, 0.5}, {0, -1, 0.6}, 0.9, 1e-6, 0.25, 1e-6, 2}};
  w.rims = {{"baffles",
             {0, 1e-3, 4e3},
             0.42,
             9e-5,
             8e-5,
             1e-9,
             2e-9,
             {1e-20, 2e-14, 3e-20},
             {{0, 0, rim_response(1e-7), {1e-10, -2e-10}}, {1, 1, rim_response(2e-7), {3e-10, 0}}}},
            {"baffles", {0, 0, 9e3}, 0.42, 5e-5, 4e-4, 3e-9, 4e-9, {1e-20, 2e-14, 3e-20}, {}}};
  w.device = "a GPU";
  w.diodes = {{"d_1", 1, true, {0.45, -0.01}, 1e-4, 2e-9, 1e-9, 5e-10},
              {"d_2", wave::DiodeRecord::none, false, {0, 0.4}, 2e-4, not_a_number, 3e-9, 2e-9}};
  wave::PolarIrradiance const light{0.5, 2, 2, {4, 3, 2, 1}, {16, 9, 4, 1}};
  w.irradiance.towards_mirror2 = {{}, light, light, light};
  w.irradiance.towards_mirror1 = {light, light, light, {}};
  w.grid_check = {6, 1e-12, {{1e-13, 2e-13}, {3e-13, 4e-13}, 5e-13, 6e-13, -7e-13}, 1e-3, not_a_number};
  w.bands = {3e-9, {{10, 20, {1e-8, 2e-8}, -1e-9}, {20, 40, {3e-8, 4e-8}, 5e-9}}, 6e-8};
  for (int mirror = 0; mirror < 2; ++mirror) {
    w.fields.push_back({4, {}});
    for (std::size_t i = 0; i < 32; ++i) w.fields.back().values.push_back(float(spread(i)));
  }
  w.warnings = {"wave: made up"};
  return w;
}

inline wave::RingRecord ring_record() {
  wave::RingRecord r;
  r.beam = "imc";
  r.power = 2e4;
  r.wavelength = 1064e-9;
  r.length = 33;
  r.grid = {4, 2};
  r.crossover = 1e-3;
  r.eigenvalue = {0.9, -0.4};
  r.reverse_eigenvalue = {0.9, -0.41};
  r.residual = 1e-7;
  r.beyond_band = 1e-9;
  r.modes = {{1, {1, 0, 0.5}, {0, -1, 0.6}, 0.9, 1e-6, 0.25, 1e-6, 2}};
  r.surfaces = {{"baffle", "pipe", false, {1, 2, 3}, 1e-8, rim_response(1e-7).levers, {3, -4}},
                {"MC1", "", true, {4, 5, 6}, 2e-8, rim_response(2e-7).levers, {}}};
  r.grid_check = wave::RingGridCheck{6, 1e-9, {{2e-10, -3e-10}, 4e-12}, 5e-6, 0.01, 0.02};
  r.warnings = {"wave: made up"};
  return r;
}

inline RunContent content(TraceResult const& trace, NoiseBudget const* noise) {
  RunContent c;
  c.files = {{"arm.yaml", "straytrace: 1\nunits: µm\n"}, {"empty.txt", ""}, {"data/steel.csv", "1, 2\r\n3, 4"}};
  c.main_file = "arm.yaml";
  c.title = "Arm with baffles, a made-up run";
  c.overrides = {"aperture=60cm", "n=40"};
  c.resolved = "straytrace: 1\n";
  c.model_hash = model_hash(std::vector<std::string>{"arm", "steel"});
  c.interferometer = "arm cavity, L = 3000 m, F = 450, copies 2";
  c.warnings = {"steel: measured 10 to 70 deg"};
  c.provenance = {"straytrace", "0.1.0", "abc1234", "g++ 12 -O3", "2024-05-01T12:00:00Z"};
  c.timing = {{"scene", 0.25}};
  c.importance = {
      {{1, 0, 0, 0.5, 0.25}, {1, 0, 0.5, 1, 0.25}, {3, 1, -1, 2, 12}}, {0.5, 0, 1e-9, 3}, {0.25, 1, 1, 0.9}};
  c.projection = projection_inputs(trace.coupling);
  c.waves = std::make_shared<wave::WaveRecord const>(wave_record());
  c.ring = std::make_shared<wave::RingRecord const>(ring_record());
  c.seam = std::make_shared<SeamCheck const>(SeamCheck{
      10.5, 2e-4, 1.4e-4, 4096, {1e-24, 2e-26, 3e-24, 4e-26, -0.01, 0.02}, {5e-24, 6e-26, 7e-24, 8e-26, 0.03, 0.04}});
  c.trace = &trace;
  c.noise = noise;
  return c;
}

inline MotionSet motion() {
  MotionSet m;
  m.bodies = {"tube", "ITM"};
  Spectrum const shake({0.1, 1, 10, 100, 1000}, {1e-12, 1e-14, 1e-18, 1e-22, 1e-26});
  m.inputs.push_back({"tube z", shake, 0, {{{0}, 2, {1, 0}}}});
  m.inputs.push_back({"ITM z", shake.scaled(1e-6), 0, {{{1}, 2, {1, 0}}}});
  return m;
}

}  // namespace straytrace::test
