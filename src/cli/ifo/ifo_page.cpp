// SPDX-License-Identifier: BSD-3-Clause
#include "cli/ifo/ifo_page.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "cli/ifo/ifo_sheets.hpp"
#include "session/build_info.hpp"

namespace straytrace::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int points_of_page = 101;

void add_drawing(Network const& n, Json& json) {
  constexpr std::array<char const*, 8> kinds = {"mirror",   "splitter",  "laser", "dump",
                                                "isolator", "modulator", "lens",  "aperture"};
  SteadyField const field(n);
  for (Network::Component const& c : n.components()) {
    json["components"].push_back({{"name", c.name}, {"kind", kinds[std::size_t(c.kind)]}});
    if (c.kind == Network::Component::Kind::splitter)
      json["components"].back()["incidence"] = std::get<MirrorParameters>(c.stated).incidence;
  }
  auto const end = [&](std::uint32_t port) {
    Network::Component const& c = n.at(n.owner_of(port));
    return Json{c.name, port - c.first_port};
  };
  json["spaces"] = Json::array();
  for (Network::Space const& s : n.spaces())
    json["spaces"].push_back({{"from", end(s.from)},
                              {"to", end(s.to)},
                              {"from_port", n.port_name(s.from)},
                              {"to_port", n.port_name(s.to)},
                              {"length", s.length},
                              {"forward", field.power_out(s.from)},
                              {"backward", field.power_in(s.from)}});
}

}  // namespace

std::vector<Sheet> page_curves(NetworkModel const& model, std::vector<double> const& band) {
  std::vector<double> hz;
  for (int i = 0; i < points_of_page; ++i)
    hz.push_back(band[0] * std::pow(band[1] / band[0], double(i) / (points_of_page - 1)));
  std::vector<Sheet> sheets;
  if (auto const curves = loop_curves(model, hz); !curves.empty()) sheets.push_back(suppression_sheet(hz, curves));
  sheets.push_back(strain_noise_sheet(strain_noise(model, hz)));
  return sheets;
}

Json page_json(OpticalNetwork const& network, std::vector<double> const& at, std::vector<Sheet> const& loops,
               std::vector<Sheet> const& curves) {
  Json json{{"title", network.title}, {"version", build_info::version}};
  add_drawing(network.model.network, json);
  std::vector<Sheet> sheets = point_sheets(operating_point(network.model));
  sheets.push_back(errors_sheet(error_signals(network.model)));
  for (double const hz : at) sheets.push_back(sensing_sheet(sensing_matrix(network.model, hz)));
  sheets.insert(sheets.end(), loops.begin(), loops.end());
  json["sheets"] = page_of(sheets);
  json["curves"] = json_of(curves);
  for (Sheet const& s : curves) json["headings"][s.name] = s.heading;
  return json;
}

}  // namespace straytrace::cli
