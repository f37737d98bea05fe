// SPDX-License-Identifier: BSD-3-Clause
// straytrace library: the materials, parts and detectors that come with the program.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "scene/model_tree.hpp"
#include "session/library_entries.hpp"

namespace straytrace::cli {
namespace {

struct LibraryOptions : PrintOptions {
  std::string name, kind, copy;
  bool force = false;
};

nlohmann::ordered_json json_of(LibraryEntry const& e) {
  return {
      {"kind", e.kind},     {"name", e.name},     {"include", e.file}, {"value", e.value}, {"wavelength", e.wavelength},
      {"status", e.status}, {"source", e.source}, {"note", e.note},    {"text", e.text}};
}

std::string shortened_to(std::string const& text, std::size_t most) {
  if (width_of(text) <= most) return text;
  std::size_t end = most - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

void print_list(std::vector<LibraryEntry> const& all) {
  std::string kind;
  Columns table;
  auto const flush = [&] {
    if (!table.rows.empty()) std::cout << aligned(table) << '\n';
  };
  for (LibraryEntry const& e : all) {
    if (e.kind != kind) {
      flush();
      kind = e.kind;
      table = {{kind, "value: low / mid / high", "wavelength", "status",
                kind == "detector" || kind == "arm" ? "" : "source"},
               {true, true, true, true, true},
               {}};
    }
    std::string const said = e.source.empty() || kind == "part" ? e.note : e.source;
    table.rows.push_back(
        {e.name, shortened_to(e.value, 58), shortened_to(e.wavelength, 14), e.status, shortened_to(said, 60)});
  }
  flush();
  std::cout << "straytrace library NAME prints one entry, --format json all; include: [library/materials.yaml],\n"
               "[library/parts.yaml] or a detector in a scene. Media and the parts of every scene need no include.\n";
}

void print_one(LibraryEntry const& e) {
  if (!e.file.empty()) std::cout << fmt::format("# include: [{}]\n", e.file);
  std::cout << e.text;
}

LibraryEntry const& find(std::vector<LibraryEntry> const& all, std::string const& name) {
  std::vector<std::string> names;
  for (LibraryEntry const& e : all) {
    if (e.name == name) return e;
    names.push_back(e.name);
  }
  throw InputError(fmt::format("the library has no '{}'", name),
                   did_you_mean(name, names, "straytrace library lists its entries"));
}

// By the first line, the comment that says what the file holds.
bool is_state_of(std::filesystem::path const& path, EmbeddedFile const& file) {
  std::string_view const text = file.text, first = text.substr(0, text.find('\n'));
  return head_of_file(path, first.size()) == first;
}

// An existing file is replaced only with --force, and only by another state of itself.
void refuse_existing(std::string const& folder, EmbeddedFile const& file, bool force) {
  std::filesystem::path const path = std::filesystem::path(folder) / file.name;
  if (!std::filesystem::exists(path)) return;
  if (!force)
    throw InputError(fmt::format("'{}' exists", path.string()), "choose another folder, or replace it with --force");
  if (!is_state_of(path, file))
    throw InputError(fmt::format("'{}' exists and is not a file of the library; it is not overwritten, even with "
                                 "--force",
                                 path.string()),
                     "choose another folder, or remove the file first");
}

// All files or none.
void copy(LibraryOptions const& wanted, std::vector<LibraryEntry> const& all, bool force) {
  namespace fs = std::filesystem;
  std::string const only = wanted.name.empty() ? "" : find(all, wanted.name).file;
  if (!wanted.name.empty() && only.empty())
    throw InputError(fmt::format("'{}' needs no include and has no file to copy", wanted.name), "remove --copy");
  std::vector<EmbeddedFile> files;
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name) && (only.empty() || file.name == only)) files.push_back(file);
  for (EmbeddedFile const& file : files) refuse_existing(wanted.copy, file, force);
  for (EmbeddedFile const& file : files) {
    fs::path const path = fs::path(wanted.copy) / file.name;
    fs::create_directories(path.parent_path());
    write_file(path.string(), file.text);
    std::cout << path.string() << '\n';
  }
}

int library(LibraryOptions const& options) {
  std::vector<LibraryEntry> all = library_entries();
  if (!options.kind.empty()) std::erase_if(all, [&](LibraryEntry const& e) { return e.kind != options.kind; });
  if (!options.copy.empty()) {
    copy(options, all, options.force);
  } else if (!options.name.empty()) {
    LibraryEntry const& e = find(all, options.name);
    if (options.json())
      std::cout << json_text(json_of(e)) << '\n';
    else
      print_one(e);
  } else if (options.json()) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (LibraryEntry const& e : all) out.push_back(json_of(e));
    std::cout << json_text(out) << '\n';
  } else {
    print_list(all);
  }
  return done;
}

}  // namespace

void add_library(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<LibraryOptions>();
  LibraryOptions& o = *options;
  auto* const command =
      app.add_subcommand("library", "List or print the materials, parts and detectors that come with the program.");
  command->add_option("NAME", o.name, "print the source of this entry");
  command->add_option("--kind", o.kind, "list only this kind: detector, arm, material, medium, part")
      ->check(CLI::IsMember({"detector", "arm", "material", "medium", "part"}));
  command->add_option("--copy", o.copy, "copy the files to this folder, to change them there");
  add_force_option(*command, o.force);
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace library --kind material\n"
      "  straytrace library oxidised_steel");
  command->callback([options, &exit_code] { exit_code = library(*options); });
}

}  // namespace straytrace::cli
