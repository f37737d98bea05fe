// SPDX-License-Identifier: BSD-3-Clause
#include "world/import/newmtl.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text/words.hpp"
#include "io/delimited_text.hpp"

namespace straytrace::world {
namespace {

// Written as 1064, 1.064 or 1064e-9: the unit follows from the size of the number.
double wavelength_in_m(double x) { return x >= 50 ? x * 1e-9 : x >= 1e-2 ? x * 1e-6 : x; }

class NewmtlReader {
 public:
  explicit NewmtlReader(std::vector<Problem>& problems) : problems_(problems) {}

  void line(TextLine const& line) {
    std::vector<TextCell> const words = words_of(line);
    std::string_view const key = words[0].text;
    if (key == "newmtl") {
      if (words.size() != 2) return complain(words[0], "'newmtl' needs one name", "write for example 'newmtl iris'");
      NewmtlMaterial m;
      m.name = words[1].text;
      m.line = line.number;
      if (std::ranges::any_of(out, [&](NewmtlMaterial const& o) { return o.name == m.name; }))
        complain(words[1], fmt::format("material '{}' is defined twice", m.name), "choose another name");
      out.push_back(m);
      return;
    }
    bool const known = key == "TR" || key == "IOR" || key == "PPM";
    if (!known) return complain(words[0], fmt::format("unknown word '{}'", key), "known: newmtl, TR, IOR, PPM");
    if (out.empty()) return complain(words[0], fmt::format("'{}' before any 'newmtl'", key), "begin with newmtl NAME");
    NewmtlMaterial& m = out.back();
    if (key == "TR") {
      two(words, m.transmit, m.reflect, "TR 0.5 0.3", 1);
    } else if (key == "PPM") {
      two(words, m.scatter_transmit, m.scatter_reflect, "PPM 100 1", 1e6);
      m.scatter_transmit *= 1e-6;
      m.scatter_reflect *= 1e-6;
    } else {
      two(words, m.index, m.wavelength, "IOR 1.45 1064", 1e6);
      m.wavelength = wavelength_in_m(m.wavelength);
    }
  }
  void finish() {
    for (NewmtlMaterial const& m : out) {
      double const sum = m.transmit + m.reflect + m.scatter_transmit + m.scatter_reflect;
      if (sum > 1 + 1e-12)
        complain({m.name, m.line, 8},
                 fmt::format("material '{}' violates energy conservation: T + R + scatter = {:g}", m.name, sum),
                 "lower TR or PPM; the remainder is absorbed");
    }
  }
  std::vector<NewmtlMaterial> out;

 private:
  void two(std::vector<TextCell> const& words, double& first, double& second, char const* example, double high) {
    if (words.size() != 3)
      return complain(words[0], fmt::format("'{}' needs two numbers", words[0].text),
                      fmt::format("write for example '{}'", example));
    double* const into[] = {&first, &second};
    for (std::size_t i = 0; i < 2; ++i) {
      std::string_view const text = words[i + 1].text;
      auto const x = number_in(text);
      if (!x || !(*x >= 0 && *x <= high))
        complain(words[i + 1], fmt::format("'{}' is not a number between 0 and {:g}", text, high),
                 fmt::format("write for example '{}'", example));
      else
        *into[i] = *x;
    }
  }
  void complain(TextCell const& where, std::string what, std::string suggestion) {
    world::complain(problems_, where, std::move(what), std::move(suggestion));
  }
  std::vector<Problem>& problems_;
};

}  // namespace

std::vector<NewmtlMaterial> read_newmtl(std::string_view written, std::vector<Problem>& problems) {
  std::string const text = with_plain_spaces(written);
  NewmtlReader reader(problems);
  for (TextLine const& line : text_lines(text, Comments::anywhere)) reader.line(line);
  reader.finish();
  return std::move(reader.out);
}

namespace {

std::string in_yaml(std::string const& name) {
  bool const plain = name.find_first_of(":#,{}[]&*!|>'\"%@`") == name.npos && name[0] != '-' && name[0] != '?';
  return plain ? name : "'" + name + "'";
}

std::string laws_of(NewmtlMaterial const& m) {
  std::string out;
  if (m.scatter_reflect > 0)
    out += fmt::format("      - {{model: lambertian, tis: {:g} ppm}}\n", m.scatter_reflect * 1e6);
  if (m.scatter_transmit > 0)
    out += fmt::format("      - {{model: lambertian, tis: {:g} ppm, through: yes}}\n", m.scatter_transmit * 1e6);
  return out.empty() ? out : "    scatter:\n" + out;
}

}  // namespace

std::string materials_table(std::vector<NewmtlMaterial> const& materials) {
  std::string out, media;
  for (NewmtlMaterial const& m : materials) {
    std::string const name = in_yaml(m.name);
    out += fmt::format("  {}:\n    specular: {{reflect: {}, transmit: {}}}\n", name, m.reflect, m.transmit);
    out += laws_of(m);
    if (m.index == 1) continue;
    media += fmt::format("  {}: {{index: {}}}", name, m.index);
    media += m.wavelength > 0 ? fmt::format("  # at {:g} nm\n", m.wavelength * 1e9) : "\n";
  }
  return (media.empty() ? "" : "media:\n" + media) + "materials:\n" + (out.empty() ? "  {}\n" : out);
}

}  // namespace straytrace::world
