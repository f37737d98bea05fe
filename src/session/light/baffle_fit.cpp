// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/baffle_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "base/input/document.hpp"
#include "io/delimited_text.hpp"
#include "session/diagnostics.hpp"
#include "session/interrupt.hpp"
#include "session/model.hpp"
#include "wave/arm/arm_diodes.hpp"

namespace straytrace::session {
namespace {

constexpr char const* example = "photodiode, power [W], error [W]";

struct Measured {
  std::vector<std::string> diodes;
  std::vector<double> power, error;  // W
  std::vector<std::uint32_t> line;
};

void check_row(Measured const& m, std::size_t i, std::vector<Problem>& problems) {
  auto const refuse = [&](std::string what, std::string remedy) {
    problems.push_back({{0, m.line[i], 0}, std::move(what), std::move(remedy)});
  };
  if (m.diodes[i].empty()) refuse("the photodiode has no name", "write its name in the column 'photodiode'");
  if (std::find(m.diodes.begin(), m.diodes.begin() + std::ptrdiff_t(i), m.diodes[i]) !=
      m.diodes.begin() + std::ptrdiff_t(i))
    refuse(fmt::format("photodiode '{}' is measured twice", m.diodes[i]), "keep one of the rows");
  if (!(m.error[i] > 0))
    refuse(fmt::format("the error of '{}' is not above zero", m.diodes[i]), "state one standard deviation in W");
}

Measured read_measured(std::string const& file) {
  static constexpr std::array<std::string_view, 2> numeric = {"power", "error"};
  std::vector<Problem> problems;
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
  if (!problems.empty()) throw errors_in(file, problems);
  Measured out;
  for (CsvTable::Row const& row : table.rows) {
    out.diodes.emplace_back(row.cells[std::size_t(name)].text);
    out.power.push_back(row.values[std::size_t(power)]);
    out.error.push_back(row.values[std::size_t(error)]);
    out.line.push_back(row.line());
    check_row(out, out.diodes.size() - 1, problems);
  }
  if (out.diodes.empty()) problems.push_back({{0, 0, 0}, "no photodiode is measured", "write a row for each"});
  if (!problems.empty()) throw errors_in(file, problems);
  return out;
}

// Solves the cavity for parameters, and chooses the measured photodiodes.
class BaffleModel {
 public:
  BaffleModel(BaffleFitRequest const& request, std::vector<FreeParameter> const& free, Measured const& measured)
      : request_(request), free_(free), progress_(request.scene.quiet), begin_(std::chrono::steady_clock::now()) {
    Eigen::VectorXd middle(Eigen::Index(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
      middle[Eigen::Index(i)] = 0.5 * (free[i].range.low + free[i].range.high);
    Model const model = model_at(middle);
    print_warnings(model.scene, request.scene);
    check(model);
    choose(expectation(model.world, HaloMoments::mean), measured);
  }

  std::string beam;
  double power = 0;  // W
  std::size_t left_out = 0;

  Eigen::VectorXd mean(Eigen::VectorXd const& at) {
    DiodeExpectation const e = expectation(model_at(at).world, HaloMoments::mean);
    return power * (e.smooth + e.halo.mean)(chosen_);
  }
  Eigen::MatrixXd covariance(Eigen::VectorXd const& at) {
    DiodeExpectation const e = expectation(model_at(at).world, HaloMoments::mean_and_covariance);
    return power * power * e.halo.covariance(chosen_, chosen_);
  }

 private:
  Model model_at(Eigen::VectorXd const& at) const {
    std::vector<std::string> overrides = request_.scene.overrides, point;
    for (std::size_t i = 0; i < free_.size(); ++i)
      point.push_back(fmt::format("{}={:.17g} {}", free_[i].name, at[Eigen::Index(i)], free_[i].unit));
    overrides.insert(overrides.end(), point.begin(), point.end());
    try {
      return read_model(request_.scene.input, overrides);
    } catch (InputError const& e) {
      throw InputError(e.problems, fmt::format("{}\nat the point {}", e.what(), fmt::join(point, ", ")), e.files);
    }
  }
  void check(Model const& model) {
    WaveSettings const& wave = model.world.wave;
    if (!wave.present || wave.photodiodes.empty())
      throw InputError(fmt::format("{} has no photodiodes", request_.scene.input),
                       "add 'photodiodes' to its table 'wave'; see docs/reference/scene.md#wave");
    power = wave.beam < model.world.beam_powers.size() ? model.world.beam_powers[wave.beam] : 0;
    if (!(power > 0))
      throw InputError(fmt::format("beam '{}' states no power, and the photodiodes measure watts", wave.beam_name),
                       "add 'power: 10 kW' to the beam");
    beam = wave.beam_name;
  }
  void choose(DiodeExpectation const& e, Measured const& measured) {
    std::vector<std::string> names;
    for (Photodiode const& d : e.diodes) names.push_back(d.name);
    std::vector<Problem> problems;
    for (std::size_t i = 0; i < measured.diodes.size(); ++i) {
      auto const at = std::ranges::find(names, measured.diodes[i]);
      if (at == names.end())
        problems.push_back({{0, measured.line[i], 0},
                            fmt::format("the scene has no photodiode '{}'", measured.diodes[i]),
                            did_you_mean(measured.diodes[i], names, "'straytrace wave SCENE' lists them")});
      chosen_.push_back(Eigen::Index(at - names.begin()));
    }
    if (!problems.empty()) throw errors_in(request_.measured, problems);
    left_out = names.size() - chosen_.size();
  }
  DiodeExpectation expectation(World const& world, HaloMoments moments) {
    if (guard_.stop()) throw InputError("interrupted; nothing was fitted", "run it again");
    ++solved_;
    std::chrono::duration<double> const passed = std::chrono::steady_clock::now() - begin_;
    progress_.at(passed.count(), [&] { return fmt::format("fit: field {}", solved_); });
    return expected_on_diodes(world, world.wave, moments, int(request_.threads));
  }

  BaffleFitRequest const& request_;
  std::vector<FreeParameter> const& free_;
  std::vector<Eigen::Index> chosen_;  // photodiodes of the scene, as measured
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
  BaffleFit out;
  std::vector<InputError> errors;
  Measured measured;
  for (std::string const& text : request.free) try {
      out.parameters.push_back(free_parameter(text));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  try {
    measured = read_measured(request.measured);
  } catch (InputError const& e) {
    errors.push_back(e);
  }
  throw_all(errors);
  BaffleModel model(request, out.parameters, measured);
  if (measured.diodes.size() <= out.parameters.size())
    throw InputError(
        fmt::format("{} measured and {} free: nothing is left to test the model", measured.diodes.size(),
                    out.parameters.size()),
        fmt::format("measure at least {} photodiodes, or free fewer parameters", out.parameters.size() + 1));
  DiodeFitProblem problem;
  for (FreeParameter const& p : out.parameters) problem.ranges.push_back(p.range);
  problem.measured = vector_of(measured.power);
  problem.error = vector_of(measured.error);
  problem.mean = [&](Eigen::VectorXd const& at) { return model.mean(at); };
  problem.covariance = [&](Eigen::VectorXd const& at) { return model.covariance(at); };
  out.fit = fit_diodes(problem);
  out.beam = model.beam;
  out.arm_power = model.power;
  out.left_out = model.left_out;
  for (std::size_t i = 0; i < measured.diodes.size(); ++i) {
    double const own = measured.error[i] / out.fit.sigma[Eigen::Index(i)];
    out.speckle.push_back(1 - own * own);
  }
  out.diodes = std::move(measured.diodes);
  out.measured = std::move(measured.power);
  out.error = std::move(measured.error);
  return out;
}

}  // namespace straytrace::session
