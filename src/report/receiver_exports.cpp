// SPDX-License-Identifier: BSD-3-Clause
// Receivers for other programs: CSV and JSON.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "report/csv.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;

std::string verdict(Estimate const& e) { return e.trusted ? "resolved" : "unresolved: " + e.why_not; }

std::string units(ReceiverTable const& table) {
  std::string const watts = table.beam_power > 0 ? fmt::format("# main mode: {} W\n", table.beam_power)
                                                 : std::string("# power of the main mode: not stated\n");
  return watts + "# power: over that of the main mode; sigma: one standard error; nan: not resolved, see verdict\n";
}

// Numbers that are not known are null, not NaN, which JSON does not have.
Json json_of(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
Json json_of(Estimate const& e) {
  return {{"value", e.trusted ? Json(e.mean) : Json(nullptr)},
          {"sigma", e.trusted ? json_of(e.std_error) : Json(nullptr)},
          {"hint", e.mean},
          {"resolved", e.trusted},
          {"why_not", e.why_not},
          {"histories_scored", e.scored}};
}

Json json_of(ReceivedRoute const& route) {
  Json j = {{"rank", route.rank},
            {"id", hash_text(route.hash)},
            {"sequence", route.sequence},
            {"power", json_of(route.power)},
            {"share", json_of(route.share.value)},
            {"share_sigma", json_of(route.share.sigma)},
            {"objects", route.objects}};
  if (route.folded_routes == 0) return j;
  j["folded_routes"] = route.folded_routes;
  for (FoldedRow const& f : route.folded)
    j["folded"].push_back({{"id", hash_text(f.hash)},
                           {"sequence", f.sequence},
                           {"power_hint", f.coupling.value},
                           {"resolved", f.trusted},
                           {"why", f.why}});
  return j;
}

Json json_of(ReceiverEntry const& r) {
  Json j;
  j["name"] = r.name;
  j["power"] = json_of(r.power);
  j["quadrants"] = Json::array();
  for (std::size_t i = 0; i < r.quadrants.mean.size(); ++i)
    j["quadrants"].push_back({{"value", json_of(r.quadrants.mean[i])}, {"sigma", json_of(r.quadrants.error[i])}});
  j["routes"] = Json::array();
  for (ReceivedRoute const& route : r.routes) j["routes"].push_back(json_of(route));
  j["census"] = Json::array();
  for (CensusRow const& row : r.census)
    j["census"].push_back({{"object", row.object},
                           {"power",
                            {{"value", r.power.trusted ? Json(row.power.value) : Json(nullptr)},
                             {"sigma", json_of(row.power.sigma)},
                             {"hint", row.power.value}}},
                           {"routes", row.routes}});
  return j;
}

}  // namespace

std::string receiver_csv(ReceiverTable const& table, RunContent const& run) {
  std::string text = file_header(run) + "# one row per receiver (rank 0: all its light) and per route\n" + units(table);
  text += "receiver,rank,id,sequence,power,power_sigma,power_hint,share_percent,verdict,histories_scored\n";
  auto const row = [&](std::string const& receiver, std::size_t rank, std::string const& id,
                       std::string const& sequence, Estimate const& e, double share) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_text(receiver), rank, id, csv_text(sequence),
                        csv_number(e.trusted, e.mean), csv_number(e.trusted, e.std_error), csv_number(true, e.mean),
                        csv_number(e.trusted, 100 * share), csv_text(verdict(e)), e.scored);
  };
  for (ReceiverEntry const& r : table.receivers) {
    row(r.name, 0, "", "all", r.power, r.power.mean > 0 ? 1 : not_a_number);
    for (ReceivedRoute const& route : r.routes)
      row(r.name, route.rank, hash_text(route.hash), route.sequence, route.power, route.share.value);
  }
  return text;
}

std::string census_csv(ReceiverTable const& table, RunContent const& run) {
  std::string text = file_header(run) + "# what the light of each receiver has met; routes: ranks in its table\n" +
                     units(table) + "receiver,object,power,power_sigma,share_percent,routes\n";
  for (ReceiverEntry const& r : table.receivers)
    for (CensusRow const& object : r.census) {
      bool const known = r.power.trusted && std::isfinite(object.power.sigma);
      std::string routes;
      for (std::size_t const rank : object.routes) routes += fmt::format("{}{}", routes.empty() ? "" : " ", rank);
      text += fmt::format("{},{},{},{},{},{}\n", csv_text(r.name),
                          csv_text(object.object.empty() ? "(routes not named)" : object.object),
                          csv_number(known, object.power.value), csv_number(known, object.power.sigma),
                          csv_number(known, 100 * object.power.value / r.power.mean), routes);
    }
  return text;
}

std::string receiver_json(ReceiverTable const& table, RunContent const& run) {
  Json j;
  j["model_hash"] = run.model_hash;
  j["seed"] = run.trace->coupling.seed;
  j["histories"] = run.trace->coupling.histories;
  j["beam_power_W"] = table.beam_power > 0 ? Json(table.beam_power) : Json(nullptr);
  j["receivers"] = Json::array();
  for (ReceiverEntry const& r : table.receivers) j["receivers"].push_back(json_of(r));
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace straytrace
