// SPDX-License-Identifier: BSD-3-Clause
#include "motion/chain.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace straytrace::motion {
namespace {

using Response = TransferFunction::Response;

constexpr double standard_gravity = 9.80665;  // m/s^2
constexpr char const* links =
    "write {resonance: {frequency: 8 Hz, quality: 50}}, {pendulum: {frequency: 0.6 Hz, quality: 10}}, {zeros: [...], "
    "poles: [...], gain: 1} or {file: FILE, columns: [Hz, re, im]}";

TransferFunction read_oscillator(Node const& t, Response response, std::string_view what) {
  double const frequency = t.number("frequency", dim::frequency, required, 1e-6),
               quality = t.number("quality", dim::plain, required, 0.5);
  t.refuse_unknown(what);
  return std::isfinite(frequency * quality) ? TransferFunction::oscillator(frequency, quality, response)
                                            : TransferFunction({}, {}, 1);
}

TransferFunction read_chain_of_masses(Node const& t) {
  std::vector<double> masses, lengths;
  for (Node const& m : t.list("masses")) masses.push_back(m.as_number(dim::mass, 1e-6));
  for (Node const& l : t.list("lengths")) lengths.push_back(l.as_number(dim::length, 1e-6));
  double const quality = t.number("quality", dim::plain, required, 0.5);
  t.refuse_unknown("'pendulum'");
  TransferFunction chain({}, {}, 1);
  if (masses.empty() || masses.size() != lengths.size()) {
    t.problem("a chain of pendulums has as many lengths as masses",
              "write 'masses: [30 kg, 40 kg], lengths: [1 m, 0.7 m]'");
    return chain;
  }
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (!std::isfinite(masses[i] * lengths[i] * quality)) return chain;  // reported already
  for (double const hz : pendulum_modes(masses, lengths))
    chain = TransferFunction::product(chain, TransferFunction::oscillator(hz, quality, Response::inertial));
  return chain;
}

TransferFunction read_table_or_roots(Node const& link) {
  if (!link.has("beyond")) return read_transfer_function(link, {});
  constexpr std::array<std::string_view, 1> only = {"hold"};
  bool const holds = !link.choice("beyond", only).empty();
  TransferFunction const t = read_transfer_function(link, {});
  return holds ? t.holding_ends() : t;
}

TransferFunction read_link(Node const& link) {
  bool const resonance = link.has("resonance"), pendulum = link.has("pendulum"), mode = link.has("mode");
  if (link.kind() != Node::Kind::table || resonance + pendulum + mode > 1) {
    link.problem("this is not one link of a chain", links);
    return {{}, {}, 1};
  }
  if (!resonance && !pendulum && !mode) {
    if (link.has("file") || link.has("gain") || link.has("zeros") || link.has("poles"))
      return read_table_or_roots(link);
    std::string near;
    std::vector<std::string> const words = {"resonance", "pendulum", "mode", "file", "zeros", "poles", "gain"};
    for (auto const& entry : link.items())
      if (near.empty()) near = nearest_word(entry.first, words);
    link.problem("the kind of this link of a chain is missing",
                 near.empty() ? links : fmt::format("did you mean '{}'?", near));
    return {{}, {}, 1};
  }
  TransferFunction const t = resonance ? read_oscillator(link.table("resonance"), Response::support, "'resonance'")
                             : mode    ? read_oscillator(link.table("mode"), Response::relative, "'mode'")
                                       : read_stages(link["pendulum"]);
  link.refuse_unknown("a link of a chain");
  return t;
}

}  // namespace

Transfer chained(Transfer const& a, Transfer const& b) {
  if (!a || !b) return a ? a : b;
  return std::make_shared<TransferFunction const>(TransferFunction::product(*a, *b));
}

bool covers(Transfer const& t, double low, double high, Node const& where) {
  constexpr double edge = 1e-9;  // relative, of a printed number
  Band const known = t ? t->range() : Band{0, infinity};
  if (low >= known.low * (1 - edge) && high <= known.high * (1 + edge)) return true;
  where.problem(fmt::format("the chain covers {:g} Hz to {:g} Hz, but the motion {:g} Hz to {:g} Hz", known.low,
                            known.high, low, high),
                "give a file that covers it, end the motion there, or write 'beyond: hold' with the file");
  return false;
}

std::complex<double> at_tone(Transfer const& t, double hz, Node const& where) {
  return t && covers(t, hz, hz, where) ? std::conj((*t)(hz)) : 1;
}

Transfer read_chain(Node const& through) {
  if (!through) return {};
  TransferFunction chain({}, {}, 1);
  for (Node const& link : through.as_list()) chain = TransferFunction::product(chain, read_link(link));
  return std::make_shared<TransferFunction const>(std::move(chain));
}

TransferFunction read_stages(Node const& stages) {
  if (stages.kind() == Node::Kind::table && stages.has("masses")) return read_chain_of_masses(stages);
  TransferFunction chain({}, {}, 1);
  for (Node const& stage : stages.as_list()) {
    if (stage.kind() == Node::Kind::table)
      chain = TransferFunction::product(chain, read_oscillator(stage, Response::inertial, "'pendulum'"));
    else
      stage.problem("a stage of a suspension is a table", "write {frequency: 0.6 Hz, quality: 10}");
  }
  return chain;
}

std::vector<double> pendulum_modes(std::vector<double> const& masses, std::vector<double> const& lengths) {
  auto const n = std::ssize(masses);
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);  // stiffness, weighted with the masses: M^-1/2 K M^-1/2
  double below = 0;                                 // mass that the thread carries
  for (auto i = n - 1; i >= 0; --i) {
    below += masses[std::size_t(i)];
    double const stiffness = standard_gravity * below / lengths[std::size_t(i)], m = masses[std::size_t(i)];
    k(i, i) += stiffness / m;
    if (i == 0) break;
    double const above = masses[std::size_t(i - 1)];
    k(i - 1, i - 1) += stiffness / above;
    k(i, i - 1) = k(i - 1, i) = -stiffness / std::sqrt(m * above);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(k, Eigen::EigenvaluesOnly);
  std::vector<double> hz;
  for (Eigen::Index i = 0; i < n; ++i) hz.push_back(std::sqrt(solver.eigenvalues()[i]) / (2 * pi));
  return hz;
}

}  // namespace straytrace::motion
