// SPDX-License-Identifier: BSD-3-Clause
// Path table and noise budget of a page.
#include <algorithm>
#include <cmath>
#include <map>

#include "page/page_json.hpp"
#include "report/band.hpp"
#include "report/csv.hpp"
#include "report/filter_words.hpp"
#include "report/markup.hpp"
#include "report/route_columns.hpp"

namespace straytrace {

PageJson number(double x) {
  if (!std::isfinite(x)) return nullptr;
  return x == 0 ? 0 : six_digits(x);
}

PageJson numbers(std::vector<double> const& all) {
  PageJson list = PageJson::array();
  for (double const x : all) list.push_back(number(x));
  return list;
}

namespace {

PageJson values_of(RouteColumn const& c) {
  if (c.is_text) return c.texts;
  PageJson list = PageJson::array();
  for (double const x : c.numbers) list.push_back(c.whole && !std::isnan(x) ? PageJson(std::int64_t(x)) : number(x));
  return list;
}

// `units`: what a filter may write behind a number, of columns of numbers.
PageJson column_json(RouteColumn const& c) {
  PageJson j{{"key", c.key}, {"title", c.title}, {"unit", c.unit}, {"help", c.help}, {"values", values_of(c)}};
  if (c.is_text) return j;
  j["units"] = c.units;
  j["whole"] = c.whole;
  j["needs_unit"] = c.needs_unit;
  return j;
}

PageJson curve_json(NoiseTrace const& t) {
  return {{"name", t.name}, {"asd", numbers(t.asd)}, {"sigma", numbers(t.sigma)}};
}

}  // namespace

PageJson table_json(PathTable const& table, CouplingTable const& coupling) {
  RouteColumns const columns(table, coupling, nullptr);
  PageJson all = PageJson::array();
  for (RouteColumn const& c : columns.all()) all.push_back(column_json(c));
  return {{"columns", all}, {"rows", columns.rows()}, {"band", {table.low, table.high}}, {"hertz", hertz()}};
}

namespace {

using Floats = std::vector<float>;

std::string floats_text(Floats const& all) { return base64(all.data(), all.size() * sizeof(float)); }

// What the page needs to leave rows out of the total: per bin, the share of the PSD of the total that a route makes,
// and asd * sigma over that PSD, of the loudest routes; the rest of the resolved ones in one sum.
PageJson shares_json(NoiseTrace const& total, std::vector<NoiseTrace const*> const& routes) {
  constexpr std::size_t most = 400;
  std::size_t const bins = total.asd.size();
  Floats share, error;
  std::vector<double> rest(bins), rest_error(bins);
  PageJson ids = PageJson::array(), rest_ids = PageJson::array();
  for (std::size_t r = 0; r < routes.size(); ++r) {
    NoiseTrace const& t = *routes[r];
    bool const own = r < most;
    (own ? ids : rest_ids).push_back(hash_text(t.hash));
    for (std::size_t k = 0; k < bins; ++k) {
      double const psd = total.asd[k] * total.asd[k];
      double const part = psd > 0 ? t.asd[k] * t.asd[k] / psd : 0, off = psd > 0 ? t.asd[k] * t.sigma[k] / psd : 0;
      if (own) {
        share.push_back(float(part));
        error.push_back(float(off));
      } else {
        rest[k] += part;
        rest_error[k] += off;
      }
    }
  }
  return {{"ids", ids},
          {"rest_ids", rest_ids},
          {"share", floats_text(share)},
          {"error", floats_text(error)},
          {"rest", floats_text({rest.begin(), rest.end()})},
          {"restError", floats_text({rest_error.begin(), rest_error.end()})}};
}

}  // namespace

PageJson budget_json(NoiseBudget const& b, PathTable const& table, std::size_t routes) {
  PageJson j;
  std::vector<double> f;
  for (std::size_t i = 0; i < b.grid.size(); ++i) f.push_back(b.grid.centre(i));
  j["frequency"] = numbers(f);
  j["total"] = curve_json(b.total);
  j["bound"] = false;
  for (std::size_t i = 0; i < b.grid.size(); ++i)
    if (at_most(b.total, i)) j["bound"] = true;
  j["phase"] = numbers(b.total.phase_asd);
  j["amplitude"] = numbers(b.total.amplitude_asd);
  NoiseBands const& d = b.bands;
  for (auto const& [name, curve] : {std::pair{"input_low", &d.input_low},
                                    {"input_high", &d.input_high},
                                    {"speckle_05", &d.speckle_05},
                                    {"speckle_50", &d.speckle_50},
                                    {"speckle_95", &d.speckle_95},
                                    {"coherent", &d.coherent}})
    j[name] = numbers(*curve);
  j["design"] = PageJson::array();
  for (DesignCurve const& c : b.design) j["design"].push_back({{"name", c.name}, {"asd", numbers(c.asd)}});
  j["margin"] = b.margin;
  j["unresolved"] = b.unresolved;
  j["routes"] = PageJson::array();
  std::map<std::uint64_t, NoiseTrace const*> by_hash;
  for (NoiseTrace const& t : b.routes) by_hash[t.hash] = &t;
  std::vector<NoiseTrace const*> resolved;
  for (PathRow const& row : table.rows) {
    auto const found = by_hash.find(row.hash);
    if (found == by_hash.end() || !found->second->resolved) continue;
    resolved.push_back(found->second);
    if (j["routes"].size() >= routes || !(row.share.value > 0)) continue;
    j["routes"].push_back({{"id", hash_text(row.hash)}, {"name", row.sequence}, {"asd", numbers(found->second->asd)}});
  }
  j["shares"] = shares_json(b.total, resolved);
  return j;
}

}  // namespace straytrace
