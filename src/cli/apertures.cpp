// SPDX-License-Identifier: BSD-3-Clause
// straytrace apertures: clipping of beams at every edge that they pass, in closed form and by the Fresnel integral.
#include "world/ghosts/apertures.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/text/json_text.hpp"
#include "base/units/quantity.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

struct AperturesOptions : SceneOptions {
  std::string profile, distance;
  std::size_t show = 12, points = 41;
};

struct Named {
  BeamAperture aperture;
  std::string beam, name;
};

std::vector<Named> named_apertures(Model const& model) {
  std::vector<Named> all;
  for (BeamAperture const& a : apertures_of(model.world))
    all.push_back({a, model.world.beams.at(a.beam).name, model.world.groups()[a.group.value]});
  std::stable_sort(all.begin(), all.end(),
                   [](Named const& a, Named const& b) { return a.aperture.clipped > b.aperture.clipped; });
  return all;
}

// The difference of the quadrature from 1 is rounding.
std::string change(double x) {
  return std::isnan(x) ? "-" : std::fabs(x) < 1e-13 ? "<1e-13" : fmt::format("{:+.2e}", x);
}
std::string number(double x, int digits) { return std::isnan(x) ? "-" : fmt::format("{:.{}g}", x, digits); }
std::string size_of(BeamAperture const& a) {
  bool const round = a.w_major - a.w_minor < 1e-4 * a.w_major;
  return fmt::format("{:.5g}", 1e3 * a.w_major) + (round ? "" : fmt::format(" x {:.5g}", 1e3 * a.w_minor));
}

void print_table(std::vector<Named> const& all, std::size_t show) {
  Columns table{
      {"beam", "rim of", "at/m", "w/mm", "radius/mm", "offset/mm", "tilt/deg", "clipped", "axis, far", "ripple"},
      {true, true},
      {}};
  for (std::size_t i = 0; i < std::min(show, all.size()); ++i) {
    BeamAperture const& a = all[i].aperture;
    table.rows.push_back({all[i].beam, all[i].name, fmt::format("{:.6g}", a.along), size_of(a),
                          number(1e3 * a.opening.radius, 5), number(1e3 * a.opening.x, 3), number(a.tilt * 180 / pi, 3),
                          fmt::format("{:.4e}", a.clipped), change(a.axis_far - 1),
                          std::isnan(a.ripple) ? "-" : fmt::format("{:.2e}", a.ripple)});
  }
  std::cout
      << "Edges that beams pass, largest clipping first. clipped: share of the power (eq. 5.5, 5.6); axis: change of\n"
         "the intensity on the axis, far behind (eq. 5.7), and at most at any distance (ripple).\n\n"
      << aligned(table);
  if (all.size() > show) std::cout << fmt::format("and {} more; --show N has more rows\n", all.size() - show);
}

nlohmann::ordered_json json_of(Named const& n) {
  BeamAperture const& a = n.aperture;
  auto const known = [](double x) { return std::isnan(x) ? nlohmann::ordered_json() : nlohmann::ordered_json(x); };
  return {{"beam", n.beam},
          {"rim_of", n.name},
          {"at_m", a.along},
          {"reflected", a.reflected},
          {"w_m", a.w_major},
          {"w_minor_m", a.w_minor},
          {"tilt_rad", known(a.tilt)},
          {"wavefront_curvature_per_m", known(a.across ? a.at.curvature : NAN)},
          {"wavelength_m", a.at.wavelength},
          {"radius_m", known(a.opening.radius)},
          {"offset_m", known(a.opening.x)},
          {"tooth_height_m", a.opening.tooth_height},
          {"teeth", a.opening.teeth},
          {"clipped", a.clipped},
          {"axis_factor_far", known(a.axis_far)},
          {"axis_ripple", known(a.ripple)}};
}

Named const& chosen(std::vector<Named> const& all, std::string const& name) {
  std::vector<std::string> names;
  for (Named const& n : all) {
    if (n.name == name) return n;
    names.push_back(n.name);
  }
  throw InputError(fmt::format("no beam passes an edge of '{}'", name),
                   did_you_mean(name, names, "straytrace apertures SCENE lists all of them"));
}

double distance_of(std::string const& text) {
  auto const number = leading_number(text);
  auto const unit = number ? parse_unit(number->rest) : std::nullopt;
  if (!unit || !(unit->dimension == dim::length) || !(number->value > 0))
    throw InputError(fmt::format("--distance: '{}' is not a distance behind the edge", text),
                     "write for example --distance \"10 m\"");
  return to_si(number->value, *unit);
}

// The Fresnel integral is computed for round beams and edges across them.
double checked_distance(Named const& n, AperturesOptions const& wanted) {
  double const z = distance_of(wanted.distance);
  BeamAperture const& a = n.aperture;
  if (!a.across)
    throw InputError(fmt::format("--profile: '{}' has no round edge about the chief ray, across a round beam", n.name),
                     "only for those the field behind is computed; the table lists the clipping of the others");
  double const least = 2 * a.at.w;
  if (z < least)
    throw InputError(fmt::format("--distance: {:g} m behind '{}' is nearer than the beam is wide", z, n.name),
                     fmt::format("the field is paraxial: choose {:.2g} m or more", least));
  return z;
}

void print_profile(Named const& n, AperturesOptions const& wanted, bool json) {
  double const z = checked_distance(n, wanted);
  auto const [x, with, without] = profile_behind(n.aperture, n.name, z, wanted.points);
  if (json) {
    nlohmann::ordered_json out = json_of(n);
    out["distance_m"] = z;
    out["paraxial_beyond_m"] = paraxial_beyond(n.aperture);
    out["x_m"] = x;
    out["intensity"] = with;
    out["intensity_without_rim"] = without;
    std::cout << json_text(out) << '\n';
    return;
  }
  std::cout << fmt::format(
      "# {} behind the rim of {}: {:g} m; intensity over that on the axis at the rim\n"
      "# paraxial: fringe positions are right beyond about {:.2g} m\n"
      "# x runs through the axis of the beam and the centre of the opening\n"
      "# x_m intensity without_rim\n",
      n.beam, n.name, z, paraxial_beyond(n.aperture));
  for (std::size_t i = 0; i < x.size(); ++i)
    std::cout << fmt::format("{:.6e} {:.9e} {:.9e}\n", x[i], with[i], without[i]);
}

int apertures(AperturesOptions const& options) {
  Model const model = read_model(options.input, options.overrides);
  print_warnings(model.scene, options);
  std::vector<Named> const all = named_apertures(model);
  if (!options.profile.empty()) {
    print_profile(chosen(all, options.profile), options, options.json());
  } else if (options.json()) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (Named const& n : all) out.push_back(json_of(n));
    std::cout << json_text(out) << '\n';
  } else if (all.empty()) {
    std::cout << "No Gaussian beam of the scene passes an edge.\n";
  } else {
    print_table(all, options.show);
  }
  return done;
}

}  // namespace

void add_apertures(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<AperturesOptions>();
  AperturesOptions& o = *options;
  auto* const command =
      app.add_subcommand("apertures", "Show the clipping of beams at clear apertures, and the light behind them.");
  add_scene_options(*command, o);
  command->add_option("--show", o.show, "rows")->check(whole_between(1, 1e6, "20"));
  auto* const profile =
      command->add_option("--profile", o.profile, "intensity across the beam behind an edge of this entry");
  command->add_option("--distance", o.distance, "of --profile, behind the edge, for example \"10 m\"")->needs(profile);
  command->add_option("--points", o.points, "of --profile")->check(whole_between(3, 100001, "101"));
  command->footer(
      "Examples:\n"
      "  straytrace apertures examples/virgo_arm.yaml\n"
      "  straytrace apertures examples/virgo_arm.yaml --profile ETM --distance \"500 m\"");
  command->callback([options, &exit_code] {
    if (!options->profile.empty() && options->distance.empty())
      throw InputError("--profile needs a distance behind the edge", "add for example --distance \"10 m\"");
    exit_code = apertures(*options);
  });
}

}  // namespace straytrace::cli
