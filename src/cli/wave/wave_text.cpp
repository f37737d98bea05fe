// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/math/constants.hpp"
#include "cli/wave/wave_output.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

double sum(std::vector<double> const& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
std::string number_text(double x) { return std::isnan(x) ? "-" : fmt::format("{:.3g}", x); }

// Root mean square over the draws of |A| along an axis; NaN where the grid does not hold the light.
double lever_rms(RimResult const& rim, std::size_t axis) {
  double squares = 0;
  auto const draws = rim.ensemble();
  for (RimResponse const* r : draws) squares += std::norm(r->levers.displacement[axis]);
  return std::sqrt(squares / double(draws.size()));
}
double widening_rms(RimResult const& rim) {
  double squares = 0;
  auto const draws = rim.ensemble();
  for (RimResponse const* r : draws) squares += std::norm(r->widening);
  return std::sqrt(squares / double(draws.size()));
}
double expected_lever(RimResult const& rim, std::size_t axis) {
  return std::sqrt(axis < 2 ? rim.speckle.transverse : rim.speckle.longitudinal);
}
// The largest transverse lever, by the method of the rim.
double transverse(RimResult const& rim) {
  if (rim.draws.empty()) return expected_lever(rim, 0);
  return std::hypot(lever_rms(rim, 0), lever_rms(rim, 1)) / std::sqrt(2.0);
}

bool misaligned(World const& world) {
  return std::ranges::any_of(world.wave.mirrors, &WaveSettings::Mirror::misaligned);
}

std::string cavity_text(ArmWaves const& waves, World const& world) {
  ArmCavity const& arm = waves.arm;
  Grid const& grid = arm.cavity.grid;
  auto const in_band = std::ranges::count_if(arm.rims, &ArmRim::in_band);
  std::string text = fmt::format(
      "cavity {}: {:.6g} m, grid of {} x {} points over {:.4g} m, which carries angles up to {:.4g} urad\n"
      "crossover angle {:.4g} urad: {} of {} inner edges are within it, seen from both mirrors\n",
      world.wave.beam_name, arm.cavity.length, grid.points, grid.points, grid.window,
      1e6 * grid.largest_angle(arm.cavity.wavelength), 1e6 * arm.crossover, in_band, arm.rims.size());
  for (ArmMirror const& m : arm.mirrors)
    text += fmt::format(
        "mirror {}: radius of the mode {:.4g} mm; heights below the crossover angle {:.3g} nm rms; scatters "
        "{:.3g} beyond it\n",
        world.name_of(m.surface), 1e3 * m.spot, 1e9 * m.roughness, m.scattered);
  if (!misaligned(world)) return text;
  for (std::size_t i : {0, 1}) {
    auto const& [found, expected] = waves.spots[i];
    text += fmt::format(
        "light on {}: centroid at ({:.5g}, {:.5g}) mm, axis of the mode at ({:.5g}, {:.5g}) mm (eq. W.23)\n",
        world.name_of(arm.mirrors[i].surface), 1e3 * found[0], 1e3 * found[1], 1e3 * expected[0], 1e3 * expected[1]);
  }
  return text;
}

// A row for each part of the loss, with its spread over draws of the heights and what a finer grid changes.
class LossTable {
 public:
  LossTable(ArmWaves const& waves, double power) : waves_(waves), power_(power) {
    table_.titles = {"loss per round trip", "share", "W"};
    table_.left = {true};
    if (waves.draws.size() > 1) table_.titles.insert(table_.titles.end(), {"median", "5 %", "95 %"});
    if (waves.grid_check) table_.titles.push_back("finer grid");
  }
  using Part = std::function<double(PowerLedger const&)>;
  void add(std::string const& what, Part const& part) {
    add(
        what, [&](ArmDraw const& d) { return part(d.ledger); },
        waves_.grid_check ? part(waves_.grid_check->ledger) : 0);
  }
  void add(std::string const& what, std::function<double(ArmDraw const&)> const& of_draw, double change) {
    std::vector<double> values;
    for (ArmDraw const& d : waves_.draws) values.push_back(of_draw(d));
    Spread const s = spread_of(values);
    bool const known = s.mean > rounding_of_shares;
    double const size = known ? s.mean : rounding_of_shares;
    std::string const below = known ? "" : "below ";
    std::vector<std::string> row{what, fmt::format("{}{:.4g}", below, size),
                                 power_ > 0 ? fmt::format("{}{:.4g}", below, size * power_) : "-"};
    if (values.size() > 1)
      for (double x : {s.median, s.low, s.high}) row.push_back(known ? fmt::format("{:.4g}", x) : "-");
    if (waves_.grid_check) row.push_back(known ? fmt::format("{:+.1e}", change) : "-");
    table_.rows.push_back(std::move(row));
  }
  std::string text() const { return aligned(table_); }

 private:
  ArmWaves const& waves_;
  double power_;
  Columns table_;
};

std::string losses_text(ArmWaves const& waves, World const& world) {
  std::string const one = world.name_of(waves.arm.mirrors[0].surface),
                    two = world.name_of(waves.arm.mirrors[1].surface);
  LossTable table(waves, arm_power(world));
  table.add("past the rim of " + one + ", and scattered", [](PowerLedger const& l) { return l.mirror1; });
  table.add("past the rim of " + two + ", and scattered", [](PowerLedger const& l) { return l.mirror2; });
  if (!waves.arm.rims.empty()) {
    table.add("on baffles, towards " + two, [](PowerLedger const& l) { return sum(l.towards_mirror2); });
    table.add("on baffles, towards " + one, [](PowerLedger const& l) { return sum(l.towards_mirror1); });
  }
  table.add("at angles that reach no opening", [](PowerLedger const& l) { return l.beyond_band; });
  table.add(
      "all", [](ArmDraw const& d) { return d.loss; }, waves.grid_check ? waves.grid_check->loss : 0);
  std::string text = "\n" + table.text();
  if (waves.draws.size() > 1)
    text += fmt::format("mean over {} draws of the heights of the mirrors, median and percentiles{}\n",
                        waves.draws.size(), waves.draws.size() < 20 ? ", here the smallest and the largest" : "");
  if (!std::isnan(waves.perfect_loss))
    text += fmt::format(
        "smooth{} mirrors without baffles lose {} (eq. W.10)\n", misaligned(world) ? " aligned" : "",
        waves.perfect_loss > rounding_of_shares ? fmt::format("{:.4g}", waves.perfect_loss) : "below 1e-12");
  return text;
}

std::string modes_text(ArmWaves const& waves) {
  if (waves.modes.empty()) return {};
  Columns table{{"order", "mode", "shared", "or", "shared", "in order", "loss", "phase/turns", "alike"},
                {false, true, false, true},
                {}};
  for (ModeLine const& m : waves.modes)
    table.rows.push_back({fmt::format("{}", m.order), fmt::format("HG{}{}", m.hermite.one, m.hermite.two),
                          fmt::format("{:.4f}", m.hermite.shared),
                          fmt::format("LG{}{}{}", m.laguerre.one, m.laguerre.two > 0 ? "+" : "", m.laguerre.two),
                          fmt::format("{:.4f}", m.laguerre.shared), fmt::format("{:.6f}", m.in_order),
                          m.loss > rounding_of_shares ? fmt::format("{:.4g}", m.loss) : "below 1e-12",
                          phase_text(m.phase), m.alike > 1 ? fmt::format("{}", m.alike) : "-"});
  return "\nModes of the mirrors without baffles, the Hermite-Gauss and the Laguerre-Gauss mode (LG p l) next to each "
         "and the power\n"
         "shared with it, and that shared with all of the order; phase of the round trip over that of the fundamental "
         "mode. alike: so\n"
         "many modes of one eigenvalue, with any combination of them; the named modes are shared with all of these "
         "together.\n\n" +
         aligned(table);
}

std::vector<std::size_t> largest_first(std::size_t count, std::function<double(std::size_t)> const& size) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, size);
  return order;
}

std::string more_rows(std::size_t count, std::size_t show) {
  return count > show ? fmt::format("and {} more; --show N has more rows\n", count - show) : "";
}

std::string rims_text(ArmWaves const& waves, World const& world, std::vector<std::size_t> const& order,
                      std::size_t show) {
  Columns table{{"edge of", "z/m", "urad from 1", "from 2", "method", "|A_x|/(1/m)", "|A_y|", "|A_z|", "radius",
                 "speckle, across", "along"},
                {true, false, false, false, true},
                {}};
  for (std::size_t i = 0; i < std::min(show, order.size()); ++i) {
    ArmRim const& rim = waves.arm.rims[order[i]];
    RimResult const& found = waves.rims[order[i]];
    table.rows.push_back({world.name_of(rim.surface), fmt::format("{:.6g}", rim.centre.z),
                          number_text(1e6 * rim.angle1), number_text(1e6 * rim.angle2), method_of(found),
                          number_text(lever_rms(found, 0)), number_text(lever_rms(found, 1)),
                          number_text(lever_rms(found, 2)), number_text(widening_rms(found)),
                          number_text(expected_lever(found, 0)), number_text(expected_lever(found, 2))});
  }
  return "\nStray field over the main field per round trip, per displacement of an inner edge (eq. W.14) and per "
         "change of its "
         "radius,\n"
         "largest first; rms over the draws. speckle: expected rms over random mirrors, by the BSDF models of the "
         "materials\n"
         "and the waves of the outlines (eq. W.29); it stands for an edge whose light the grid does not hold.\n\n" +
         aligned(table) + more_rows(order.size(), show);
}

std::string spread_text(ArmWaves const& waves, World const& world, std::vector<std::size_t> const& order,
                        std::size_t show) {
  Columns table{
      {"edge of", "z/m", "across, mean", "median", "5 %", "95 %", "along, mean", "median", "5 %", "95 %"}, {true}, {}};
  std::size_t draws = 0, solved = 0;
  for (std::size_t const i : order) {
    RimResult const& found = waves.rims[i];
    if (found.draws.empty() || ++solved > show) continue;
    draws = found.ensemble().size();
    std::vector<std::string> row{world.name_of(waves.arm.rims[i].surface),
                                 fmt::format("{:.6g}", waves.arm.rims[i].centre.z)};
    for (bool const along : {false, true}) {
      Spread const s = lever_spread(found, along);
      for (double x : {s.mean, s.median, s.low, s.high}) row.push_back(number_text(x));
    }
    table.rows.push_back(std::move(row));
  }
  if (draws < 2) return {};
  return fmt::format(
             "\nThe same over {} draws ({} of the heights of the mirrors), across: sqrt((|A_x|^2 + |A_y|^2)/2), along: "
             "|A_z|, in 1/m{}.\n\n",
             draws, waves.draws.size(), draws < 20 ? "; percentiles of fewer than 20 draws are their ends" : "") +
         aligned(table) + more_rows(solved, show);
}

// Light that falls beyond the edge of the opening, in eighths of the circle.
std::string light_text(ArmWaves const& waves, World const& world, std::size_t show) {
  constexpr std::size_t eighths = 8;
  double const watts = arm_power(world), unit = watts > 0 ? watts : 1;
  Columns table{{"baffle", "z/m", "towards", "all"}, {true, false, true}, {}};
  for (std::size_t e = 0; e < eighths; ++e) table.titles.push_back(fmt::format("{}", 45 * e));
  auto const on = [&](std::size_t i) { return waves.ledger.towards_mirror1[i] + waves.ledger.towards_mirror2[i]; };
  std::vector<std::size_t> const order = largest_first(waves.rims.size(), on);
  for (std::size_t row = 0; row < std::min(show, order.size()); ++row)
    for (Travel const travel : {Travel::towards_mirror2, Travel::towards_mirror1}) {
      std::size_t const i = order[row];
      bool const first = travel == Travel::towards_mirror2;
      PolarIrradiance const& light = waves.irradiance.of(int(i) + 1, travel);
      std::vector<double> const sectors = light.beyond(waves.arm.cavity.baffles[i].rim);
      auto const light_of = [&](double share) {
        return share > rounding_of_shares ? number_text(unit * share)
                                          : fmt::format("<{:.1g}", unit * rounding_of_shares);
      };
      std::vector<std::string> cells{first ? world.name_of(waves.arm.rims[i].surface) : "",
                                     first ? fmt::format("{:.6g}", waves.arm.rims[i].centre.z) : "",
                                     world.name_of(waves.arm.mirrors[first ? 1 : 0].surface), light_of(sum(sectors))};
      std::size_t const each = sectors.size() / eighths;
      for (std::size_t e = 0; e < eighths; ++e)
        cells.push_back(light_of(std::accumulate(sectors.begin() + std::ptrdiff_t(e * each),
                                                 sectors.begin() + std::ptrdiff_t((e + 1) * each), 0.0)));
      table.rows.push_back(std::move(cells));
    }
  return fmt::format(
             "\nLight on baffles in {}, most light first: all, and by azimuth in eighths of the circle that begin at "
             "this angle\nin degrees, from x towards y.\n\n",
             watts > 0 ? "W" : "shares of the power of the mode") +
         aligned(table) + more_rows(order.size(), show);
}

std::string bands_text(ArmWaves const& waves, World const& world) {
  if (!waves.bands) return {};
  HeightBands const& f = *waves.bands;
  ArmCavity const& arm = waves.arm;
  double const resolved = resolved_loss_of_bands * waves.draws.front().loss;
  Columns table{{"heights", "to urad", "scattered by " + world.name_of(arm.mirrors[0].surface),
                 world.name_of(arm.mirrors[1].surface), "loss", "share that leaves"},
                {true},
                {}};
  double rest = waves.draws.front().loss - f.smooth - f.beyond;
  auto const loss_text = [&](double loss) {
    return std::fabs(loss) > resolved ? number_text(loss) : fmt::format("within {:.1g}", resolved);
  };
  table.rows.push_back({"none", "", "", "", loss_text(f.smooth), ""});
  for (HeightBand const& b : f.bands) {
    double const scattered = b.scattered[0] + b.scattered[1];
    bool const known = std::fabs(b.loss) > resolved;
    table.rows.push_back({fmt::format("{:.3g} to {:.3g} /m", b.from, b.to),
                          fmt::format("{:.3g}", 1e6 * b.to * arm.cavity.wavelength), number_text(b.scattered[0]),
                          number_text(b.scattered[1]), loss_text(b.loss),
                          known && scattered > 0 ? number_text(b.loss / scattered) : "-"});
    rest -= b.loss;
  }
  table.rows.push_back({fmt::format("above {:.3g} /m", arm.crossover / arm.cavity.wavelength), "",
                        number_text(arm.mirrors[0].scattered), number_text(arm.mirrors[1].scattered),
                        number_text(f.beyond), "1"});
  table.rows.push_back({"between bands", "", "", "", fmt::format("{:+.2g}", rest), ""});
  return "\nLoss per round trip by the spatial frequency of the heights, of the first draw. In each row the mirrors "
         "have "
         "these\n"
         "heights alone; light that they scatter, to first order; what the cavity loses over smooth mirrors (eq. "
         "W.34).\n\n" +
         aligned(table);
}

std::string grid_text(ArmWaves const& waves) {
  if (!waves.grid_check) return "not checked; --grid-check solves again on a grid of 1.4 times the points";
  GridCheck const& g = *waves.grid_check;
  std::string text =
      fmt::format("{} points change the loss by {:+.2g} of itself", g.points, g.loss / waves.draws.front().loss);
  if (!std::isnan(g.across))
    text +=
        fmt::format(", levers of edges by up to {:.2g} (across) and {:.2g} (along) of their rms", g.across, g.along);
  if (!std::isnan(g.expected))
    text += fmt::format(", the expected levers of the others by {:+.2g} %", 100 * g.expected);
  return text;
}

std::string errors_text(ArmWaves const& waves) {
  ArmDraw const& d = waves.draws.front();
  double const k4 = 4 * pi / waves.arm.cavity.wavelength, delay = waves.arm.cavity.length / speed_of_light;
  auto const second = [&](std::size_t i) { return std::pow(k4 * waves.arm.mirrors[i].roughness, 2); };
  Columns table{{"error", ""}, {true, true}, {}};
  table.rows.push_back({"grid", grid_text(waves)});
  table.rows.push_back(
      {"solver",
       fmt::format("residual {:.1g} of the field after {} round trips (eq. W.9), some {:.1g} of the power; the "
                   "parts of the loss sum to it within {:.1g}",
                   d.residual, d.round_trips, d.residual * d.residual,
                   std::max(std::fabs(d.ledger.total() - d.loss), rounding_of_shares))});
  table.rows.push_back({"heights", waves.draws.size() > 1
                                       ? fmt::format("{} draws, above", waves.draws.size())
                                       : std::string("one draw; 'map_draws' in the scene gives the range over draws")});
  table.rows.push_back(
      {"left out", fmt::format("scatter of second order, (4 pi sigma/lambda)^2 = {:.1g} and {:.1g} of that "
                               "of first order; walls between baffles;",
                               second(0), second(1))});
  table.rows.push_back({"", fmt::format("polarisation; the delay, f L/c = {:.2g} at 100 Hz", 100 * delay)});
  return "\n" + aligned(table);
}

}  // namespace

Spread lever_spread(RimResult const& rim, bool along) {
  std::vector<double> sizes;
  for (RimResponse const* r : rim.ensemble()) {
    auto const& a = r->levers.displacement;
    sizes.push_back(along ? std::abs(a[2]) : std::hypot(std::abs(a[0]), std::abs(a[1])) / std::sqrt(2.0));
  }
  return spread_of(sizes);
}

std::string wave_text(ArmWaves const& waves, World const& world, std::size_t show) {
  std::string text =
      cavity_text(waves, world) + losses_text(waves, world) + bands_text(waves, world) + modes_text(waves);
  if (!waves.rims.empty()) {
    std::vector<std::size_t> const order =
        largest_first(waves.rims.size(), [&](std::size_t i) { return transverse(waves.rims[i]); });
    text +=
        rims_text(waves, world, order, show) + spread_text(waves, world, order, show) + light_text(waves, world, show);
  }
  return text + photodiodes_text(waves, world, show) + errors_text(waves);
}

// Photodiodes of the field, as text and CSV.

namespace {

// Over the power of the mode, or in W where the beam states its power.
double diode_scale(World const& world) { return arm_power(world) > 0 ? arm_power(world) : 1; }

double first_draw(DiodeResult const& found) { return found.draws.empty() ? not_a_number : found.draws.front(); }

}  // namespace

std::string photodiodes_text(ArmWaves const& waves, World const& world, std::size_t show) {
  if (waves.diodes.empty()) return "";
  bool const several = waves.draws.size() > 1;
  Columns table{{"photodiode", "radius/mm", "azimuth/deg", arm_power(world) > 0 ? "W" : "share"}, {true}, {}};
  if (several) table.titles.push_back("of draws");
  table.titles.insert(table.titles.end(), {"mean", "spread"});
  double const scale = diode_scale(world);
  for (std::size_t i = 0; i < std::min(show, waves.diodes.size()); ++i) {
    Photodiode const& d = waves.arm.diodes[i];
    DiodeResult const& found = waves.diodes[i];
    std::vector<std::string> row{d.name, fmt::format("{:.4g}", 1e3 * d.radius),
                                 fmt::format("{:.4g}", d.azimuth * 180 / pi),
                                 finite_text(scale * first_draw(found), "{:.4g}")};
    if (several) row.push_back(found.draws.empty() ? "-" : fmt::format("{:.4g}", scale * spread_of(found.draws).mean));
    row.push_back(fmt::format("{:.4g}", scale * found.mean));
    row.push_back(fmt::format("{:.2g}", scale * found.spread));
    table.rows.push_back(std::move(row));
  }
  std::string text = fmt::format(
      "\nLight on photodiodes: with the heights of the mirrors as first drawn{}; mean and standard deviation over all "
      "heights\nthat no map states (eq. W.41, W.43).\n\n{}",
      several ? ", mean of the draws" : "", aligned(table));
  if (waves.diodes.size() > show)
    text += fmt::format("and {} more; --show N has more rows\n", waves.diodes.size() - show);
  return text;
}

std::string photodiodes_csv(ArmWaves const& waves, World const& world) {
  char const* const unit = arm_power(world) > 0 ? "W" : "W/W";
  std::string text = fmt::format("photodiode,x [m],y [m],power [{0}],mean [{0}],spread [{0}]\n", unit);
  double const scale = diode_scale(world);
  for (std::size_t i = 0; i < waves.diodes.size(); ++i) {
    Photodiode const& d = waves.arm.diodes[i];
    DiodeResult const& found = waves.diodes[i];
    text +=
        fmt::format("{},{},{},{},{},{}\n", csv_text(d.name), d.x + d.radius * std::cos(d.azimuth),
                    d.y + d.radius * std::sin(d.azimuth), csv_number(!found.draws.empty(), scale * first_draw(found)),
                    scale * found.mean, scale * found.spread);
  }
  return text;
}

}  // namespace straytrace::cli
