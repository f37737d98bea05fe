// SPDX-License-Identifier: BSD-3-Clause
// The files of one model, their problems, and the evaluation of scalars.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "base/input/document.hpp"
#include "scene/expression.hpp"
#include "scene/scene.hpp"

namespace straytrace::scene {

struct Source {
  std::string name;  // relative to the folder of the main file
  std::string text;
  bool stored = true;                                 // part of FileTexts
  std::vector<std::size_t> lines{};                   // byte where each line begins
  std::string_view line(std::uint32_t number) const;  // 1-based, without line end; empty beyond the end
};

// The user of a part: problems in the source `hidden` are reported there.
struct Blame {
  std::uint32_t hidden = 0;
  Place place;
  std::uint32_t width = 1;
  std::string name;
  std::shared_ptr<NodeData const> entry;  // with the parameters of the part
};

constexpr std::string_view command_line_name = "command line";

class SceneDocument : public Document {
 public:
  // Reads below `folder`, or only from `texts` when given.
  SceneDocument(std::filesystem::path folder, FileTexts const* texts, std::vector<std::string> const& overrides);

  void add(Problem) override;
  void withdraw(Problem) override;
  std::size_t errors() const override { return errors_; }
  std::optional<Value> evaluate(NodeData const&, Scope const*) override;
  std::optional<Value> evaluate(NodeData const&, ParameterLookup const&);
  std::optional<std::string> origin(std::string_view expression, Scope const*) const override;
  std::string data_file(Node const& from, std::string const& name) override;
  std::optional<std::string> optional_file(Node const& from, std::string const& name) override;
  std::optional<std::string> derived_file(Node const& from, std::string const& name,
                                          std::function<std::optional<std::string>()> const& make) override;
  Place place_in_file(Node const& from, std::string const& name, std::uint32_t line, std::uint32_t column) override;

  std::uint32_t add_source(std::string name, std::string text, bool stored);
  std::uint32_t command_line();  // the source of that name, whose lines are "-p name=value"
  // Reads a file that was named in a file of the model; its index, or empty and a problem at `named_by`.
  std::optional<std::uint32_t> open(Node const& named_by, std::string const& written, std::size_t size_limit);
  // Reads the main file; throws InputError when there is none.
  std::uint32_t open_main(std::string const& name);

  Source const& source(std::uint32_t file) const { return sources_.at(file); }
  FileTexts const& files() const { return files_; }
  std::vector<std::string> source_names() const;
  std::vector<Problem> problems(Severity) const;  // sorted by place
  std::size_t error_count() const { return errors_; }

  std::optional<Blame> blame;  // set by ProblemRedirect (parts.hpp)
  Document* keep(std::unique_ptr<Document> view) { return views_.emplace_back(std::move(view)).get(); }

 private:
  Problem where_the_user_can_act(Problem) const;
  NodeData::Entry const* blamed_parameter(Problem const&) const;
  // Path of a file that a file of the model names.
  std::string name_from(Node const& named_by, std::string const& written) const;
  std::optional<std::uint32_t> open_library(std::string const& name, std::string const& written);
  std::optional<std::uint32_t> known_source(std::string const& name) const;
  std::optional<std::string> read(std::string const& name, std::size_t size_limit, std::string& why);

  std::filesystem::path folder_;
  FileTexts const* texts_;
  std::vector<std::string> overrides_;
  std::vector<Source> sources_;
  FileTexts files_;
  std::vector<Problem> problems_;
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::string>> seen_;
  std::size_t errors_ = 0;
  std::optional<std::uint32_t> command_line_;
  std::vector<std::unique_ptr<Document>> views_;  // that nodes hold
};

constexpr std::size_t model_file_limit = std::size_t{16} << 20;  // bytes
constexpr std::size_t data_file_limit = std::size_t{256} << 20;

// Texts that another program holds and has not saved: an editor, or Python.

// From now on a model that names `file` reads `text`; the file need not exist. To be called before anything is read.
void set_unsaved(std::filesystem::path const& file, std::string text);
void forget_unsaved(std::filesystem::path const& file);
std::optional<std::string> unsaved_text(std::filesystem::path const& file);
std::vector<std::string> unread_unsaved();  // names that no model has read so far

// Problems as text for people (docs/reference/scene.md).

std::string rendered_errors(SceneDocument const&);    // with the closing line "5 errors. Nothing was run."
std::string rendered_warnings(SceneDocument const&);  // one sentence per kind: count and first place
// Throws InputError when the document has errors.
void throw_errors(SceneDocument const&);

// Every warning of the scene with its place, as a JSON list (problems_as_json); empty when there is none.
std::string warnings_as_json(Scene const&);

}  // namespace straytrace::scene
