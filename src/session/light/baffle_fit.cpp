// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/baffle_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "io/delimited_text.hpp"
#include "scene/scene_document.hpp"
#include "session/interrupt.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"
#include "wave/arm/irradiance.hpp"

namespace straytrace::session {
namespace {

constexpr char const* example = "photodiode, power [W], error [W]";

struct Measured {
  std::vector<std::string> diodes;
  std::vector<double> power, error;  // W
  std::vector<Place> place;          // of the names
};

void check_row(Measured const& m, std::size_t i, Place error, std::vector<Problem>& problems) {
  auto const refuse = [&](Place at, std::string what, std::string remedy) {
    problems.push_back({at, std::move(what), std::move(remedy)});
  };
  std::string const& name = m.diodes[i];
  if (name.empty()) refuse(m.place[i], "the photodiode has no name", "write its name in the column 'photodiode'");
  if (std::find(m.diodes.begin(), m.diodes.begin() + std::ptrdiff_t(i), name) != m.diodes.begin() + std::ptrdiff_t(i))
    refuse(m.place[i], fmt::format("photodiode '{}' is measured twice", name), "keep one of the rows");
  if (!(m.error[i] > 0))
    refuse(error, fmt::format("the error of '{}' is not above zero", name),
           "state one standard deviation, in the unit of the column");
}

Place place_of(io::TextCell const& cell) { return {0, cell.line, cell.column}; }

// The rows, with those that have problems.
Measured read_measured(std::string const& file, std::vector<Problem>& problems) {
  static constexpr std::array<std::string_view, 2> numeric = {"power", "error"};
  CsvTable const table = parse_csv_table(read_text(file), Comments::whole_lines, example, problems, numeric);
  int const name = table.find("photodiode"), power = table.find("power"), error = table.find("error");
  if (problems.empty())
    for (auto const& [column, title] :
         {std::pair{name, "photodiode"}, std::pair{power, "power"}, std::pair{error, "error"}}) {
      if (column < 0)
        problems.push_back(
            {{0, 1, 1}, fmt::format("no column '{}'", title), fmt::format("write the header '{}'", example)});
      else if (auto const& c = table.columns[std::size_t(column)]; column != name && c.unit.dimension != dim::power)
        problems.push_back({{0, c.line, c.at}, wrong_unit(c, dim::power), fmt::format("write '{} [W]'", title)});
    }
  Measured out;
  if (name < 0 || power < 0 || error < 0) return out;
  for (CsvTable::Row const& row : table.rows) {
    out.diodes.emplace_back(row.cells[std::size_t(name)].text);
    out.power.push_back(row.values[std::size_t(power)]);
    out.error.push_back(row.values[std::size_t(error)]);
    out.place.push_back(place_of(row.cells[std::size_t(name)]));
    check_row(out, out.diodes.size() - 1, place_of(row.cells[std::size_t(error)]), problems);
  }
  if (out.diodes.empty() && problems.empty())
    problems.push_back({{0, 0, 0}, "no photodiode is measured", "write a row for each"});
  return out;
}

// Numbers of the measured photodiodes among those of the scene.
std::vector<Eigen::Index> chosen_among(std::vector<Photodiode> const& diodes, Measured const& measured,
                                       std::vector<Problem>& problems) {
  std::vector<std::string> names;
  for (Photodiode const& d : diodes) names.push_back(d.name);
  std::vector<Eigen::Index> chosen;
  for (std::size_t i = 0; i < measured.diodes.size(); ++i) {
    std::string const& name = measured.diodes[i];
    auto const at = std::ranges::find(names, name);
    if (at == names.end() && !name.empty())
      problems.push_back({measured.place[i], fmt::format("the scene has no photodiode '{}'", name),
                          did_you_mean(name, names, "'straytrace wave SCENE' lists them")});
    chosen.push_back(Eigen::Index(at - names.begin()));
  }
  return chosen;
}

std::string setting(FreeParameter const& p, double value) {
  return fmt::format("{}={}{}{}", p.name, value, p.unit.empty() ? "" : " ", p.unit);
}

Model model_with(SceneOptions const& scene, std::vector<std::string> const& point) {
  std::vector<std::string> overrides = scene.overrides;
  overrides.insert(overrides.end(), point.begin(), point.end());
  try {
    return read_model(scene.input, overrides);
  } catch (InputError const& e) {
    if (point.empty()) throw;
    throw InputError(e.problems, fmt::format("{}\nat the point {}", e.what(), fmt::join(point, ", ")), e.files);
  }
}

double power_of(Model const& model) {
  std::size_t const beam = model.world.wave.beam;
  return beam < model.world.beam_powers.size() ? model.world.beam_powers[beam] : 0;
}

// Finds all that is wrong with a request before the first field.
class RequestCheck {
 public:
  explicit RequestCheck(BaffleFitRequest const& request) : request_(request) {}

  // Throws one InputError.
  void run() {
    read_free();
    std::vector<Problem> problems;
    collect([&] { measured = read_measured(request_.measured, problems); });
    std::optional<Model> model;
    collect([&] { model = model_with(request_.scene, {}); });
    if (model) {
      print_warnings(model->scene, request_.scene);
      collect([&] { check(*model); });
      if (model->arm && !model->arm->diodes.empty()) chosen = chosen_among(model->arm->diodes, measured, problems);
      if (model->arm) diodes = model->arm->diodes.size();
    }
    if (!problems.empty()) errors_.push_back(errors_in(request_.measured, problems));
    for (std::size_t i = 0; i < free.size(); ++i) check_ends(i, model.has_value());
    if (std::size_t const all = measured.diodes.size(); all > 0 && all <= free.size())
      errors_.emplace_back(fmt::format("{} measured and {} free: nothing is left to test the model", all, free.size()),
                           fmt::format("measure at least {} photodiodes, or free fewer parameters", free.size() + 1));
    throw_all(errors_);
  }

  std::vector<FreeParameter> free;
  Measured measured;
  std::vector<Eigen::Index> chosen;  // photodiodes of the scene, as measured
  std::size_t diodes = 0;            // of the scene

 private:
  void collect(auto const& step) {
    try {
      step();
    } catch (InputError const& e) {
      errors_.push_back(e);
    }
  }
  void read_free() {
    for (std::string const& text : request_.free)
      collect([&] {
        FreeParameter const p = free_parameter(text);
        if (std::ranges::find(free, p.name, &FreeParameter::name) != free.end())
          throw InputError(fmt::format("--free: '{}' is free twice", p.name), "keep one of the ranges");
        for (std::string const& set : request_.scene.overrides)
          if (set.substr(0, set.find('=')) == p.name)
            throw InputError(fmt::format("--free and -p both set '{}'", p.name),
                             "remove -p, or keep it and fit other parameters");
        free.push_back(p);
        texts_.push_back(text);
      });
  }
  static void check(Model const& model) {
    WaveSettings const& wave = model.world.wave;
    if (!wave.present || wave.photodiodes.empty())
      throw InputError(fmt::format("{} has no photodiodes", model.scene.main_file()),
                       "add 'photodiodes' to its table 'wave'; see docs/reference/scene.md#wave");
    if (!(power_of(model) > 0))
      throw InputError(fmt::format("beam '{}' states no power, and the photodiodes measure watts", wave.beam_name),
                       "add 'power: 10 kW' to the beam");
  }
  // Of one parameter, both ends of its range: a number of 0 between them needs no unit.
  void check_ends(std::size_t i, bool sound) {
    FreeParameter const& p = free[i];
    for (double const end : {p.range.low, p.range.high}) try {
        model_with(request_.scene, {setting(p, end)});
      } catch (InputError const& e) {
        if (tell_of_option(e, texts_[i])) return;
        if (!sound) return;  // the scene has errors of its own
        errors_.push_back(e);
        return;
      }
  }
  // Problems of the last setting on the command line, which is that of the option.
  bool tell_of_option(InputError const& e, std::string const& text) {
    bool told = false;
    for (Problem const& p : e.problems)
      if (p.place.file < e.files.size() && e.files[p.place.file] == command_line_name &&
          p.place.line > request_.scene.overrides.size()) {
        errors_.emplace_back(fmt::format("--free \"{}\": {}", text, p.what), p.suggestion);
        told = true;
      }
    return told;
  }

  BaffleFitRequest const& request_;
  std::vector<std::string> texts_;  // of --free, as `free`
  std::vector<InputError> errors_;
};

// Solves the cavity for parameters.
class BaffleModel {
 public:
  BaffleModel(BaffleFitRequest const& request, RequestCheck const& checked)
      : request_(request),
        free_(checked.free),
        chosen_(checked.chosen),
        progress_(request.scene.quiet),
        begin_(std::chrono::steady_clock::now()) {}

  Eigen::VectorXd mean(Eigen::VectorXd const& at) {
    Model const model = model_at(at);
    DiodeExpectation const e = expectation(model.world, HaloMoments::mean);
    return power_of(model) * (e.smooth + e.halo.mean)(chosen_);
  }
  Eigen::MatrixXd covariance(Eigen::VectorXd const& at) {
    Model const model = model_at(at);
    DiodeExpectation const e = expectation(model.world, HaloMoments::mean_and_covariance);
    return std::pow(power_of(model), 2) * e.halo.covariance(chosen_, chosen_);
  }
  Model model_at(Eigen::VectorXd const& at) const {
    std::vector<std::string> point;
    for (std::size_t i = 0; i < free_.size(); ++i) point.push_back(setting(free_[i], at[Eigen::Index(i)]));
    return model_with(request_.scene, point);
  }

 private:
  DiodeExpectation expectation(World const& world, HaloMoments moments) {
    if (guard_.stop()) throw InputError("interrupted; nothing was fitted", "run it again");
    ++solved_;
    std::chrono::duration<double> const passed = std::chrono::steady_clock::now() - begin_;
    progress_.at(passed.count(), [&] { return fmt::format("fit: field {}", solved_); });
    return expected_on_diodes(world, world.wave, moments, int(request_.threads));
  }

  BaffleFitRequest const& request_;
  std::vector<FreeParameter> const& free_;
  std::vector<Eigen::Index> const& chosen_;
  InterruptGuard const guard_;
  ProgressLine progress_;
  std::chrono::steady_clock::time_point begin_;
  int solved_ = 0;
};

Eigen::VectorXd vector_of(std::vector<double> const& values) {
  return Eigen::Map<Eigen::VectorXd const>(values.data(), Eigen::Index(values.size()));
}

}  // namespace

FreeParameter free_parameter(std::string const& text) {
  auto const refuse = [&](std::string const& why) {
    return InputError(fmt::format("--free: '{}' {}", text, why), "write --free \"tilt=-1..1 urad\"");
  };
  std::size_t const equals = text.find('='), dots = text.find("..", equals == text.npos ? 0 : equals);
  if (equals == text.npos || equals == 0) throw refuse("names no parameter with its range");
  if (dots == text.npos) throw refuse("has no range");
  auto const low = leading_number(text.substr(equals + 1, dots - equals - 1)),
             high = leading_number(text.substr(dots + 2));
  if (!low || !high) throw refuse("is not a range of numbers");
  if (!low->rest.empty() && low->rest != high->rest) throw refuse("has two units");
  if (!(low->value < high->value)) throw refuse("does not rise from its first number to its second");
  return {text.substr(0, equals), high->rest, {low->value, high->value}};
}

BaffleFit fit_baffle(BaffleFitRequest const& request) {
  RequestCheck checked(request);
  checked.run();
  Measured& measured = checked.measured;
  BaffleModel model(request, checked);
  DiodeFitProblem problem;
  for (FreeParameter const& p : checked.free) problem.ranges.push_back(p.range);
  problem.measured = vector_of(measured.power);
  problem.error = vector_of(measured.error);
  problem.mean = [&](Eigen::VectorXd const& at) { return model.mean(at); };
  problem.covariance = [&](Eigen::VectorXd const& at) { return model.covariance(at); };
  BaffleFit out;
  out.fit = fit_diodes(problem);
  std::vector<double> values;
  for (DiodeFit::Parameter const& p : out.fit.parameters) values.push_back(p.value);
  Model const best = model.model_at(vector_of(values));
  out.beam = best.world.wave.beam_name;
  out.arm_power = power_of(best);
  out.left_out = checked.diodes - checked.chosen.size();
  for (std::size_t i = 0; i < measured.diodes.size(); ++i) {
    double const own = measured.error[i] / out.fit.sigma[Eigen::Index(i)];
    out.speckle.push_back(1 - own * own);
  }
  out.diodes = std::move(measured.diodes);
  out.measured = std::move(measured.power);
  out.error = std::move(measured.error);
  out.parameters = std::move(checked.free);
  return out;
}

}  // namespace straytrace::session
