// SPDX-License-Identifier: BSD-3-Clause
// Reader of the table `bodies`: the motion of each body and the references between bodies.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "motion/axis_motion.hpp"
#include "motion/motion.hpp"

namespace straytrace::motion {

struct Term {
  std::size_t input;
  std::complex<double> gain;
  Transfer through;
};
using Terms = std::vector<Term>;
using Axes = std::array<Terms, 6>;

class MotionReader {
 public:
  explicit MotionReader(Node const& table);

  bool knows(std::string const& name) const { return bodies_.contains(name); }
  // Motion of a body in terms of the inputs; resolves the bodies it refers to.
  Axes const& resolve(std::string const& name);
  void use(std::string const& name) { bodies_.at(name).used = true; }  // light reaches it, or it carries another body
  // Reports unused bodies; `of_run`: the bodies of a traced run, or null.
  void finish(std::vector<std::string> const* of_run);
  std::vector<MotionInput> inputs;
  std::vector<MotionFile> files;

 private:
  enum class State { untouched, under_way, done };
  struct Body {
    Node node;
    bool is_mode = false;  // an elastic mode of the body before the stroke: one coordinate, the first
    State state = State::untouched;
    Axes axes = {};
    bool used = false;
  };
  // One body while its coordinates are resolved: they may refer to each other.
  struct Draft {
    std::string const& name;
    std::array<AxisMotion, 6> written;
    std::array<State, 6> state{};
    Axes axes;
  };

  void read_body(std::string const& name, Body& body);
  void read_mode(std::string const& name, Body& body);
  Axes const* carrier(std::string const& name, std::string const& target, Node const& where);
  void carry_along(std::string const& name, Node const& other, Transfer const& through, Body& body);
  void resolve_axis(Draft& draft, int axis);
  void note_files(Draft const& draft, Axes const& axes, bool is_mode);
  void resolve_reference(Draft& draft, int axis, AxisReference const& reference);
  std::size_t gaussian(std::string name, OwnMotion const&);
  std::size_t tone(Tone const&);
  std::size_t drift();
  std::size_t joint_input(JointMotion const&, std::size_t column);
  Term passed_on(Term term, double scale, Transfer const& through, Node const& where) const;
  Term independent(Term const&, std::string name, AxisReference const&);

  std::map<std::string, Body> bodies_;
  std::map<std::pair<std::string, std::size_t>, std::size_t> joint_inputs_;
};

}  // namespace straytrace::motion
