// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/pattern.hpp"
#include "base/units/quantity.hpp"
#include "cli/commands.hpp"
#include "session/model.hpp"

namespace straytrace::cli {

CLI::Validator number_between(double low, double high, std::string const& example) {
  return {[=](std::string const& text) -> std::string {
            auto const number = is_number(text) ? leading_number(text) : std::nullopt;
            if (number && number->value >= low && number->value <= high) return {};
            std::string pointed = text;
            std::replace(pointed.begin(), pointed.end(), ',', '.');
            if (pointed != text && is_number(pointed))
              return fmt::format("'{}' has a decimal comma; write a decimal point: {}", text, pointed);
            return fmt::format("'{}' is not a number from {:g} to {:g}; write for example {}", text, low, high,
                               example);
          },
          ""};
}

CLI::Validator whole_between(double low, double high, std::string const& example) {
  return {[=](std::string const& text) -> std::string {
            bool const digits = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
            if (digits && text.size() < 17 && std::stod(text) >= low && std::stod(text) <= high) return {};
            return fmt::format("'{}' is not a whole number from {:.0f} to {:.0f}; write for example {}", text, low,
                               high, example);
          },
          ""};
}

namespace {

std::string trimmed(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(" \t"), text.size()));
  text.erase(text.find_last_not_of(" \t") + 1);
  return text;
}

}  // namespace

std::vector<double> parse_frequencies(std::string const& list, char const* option) {
  std::vector<double> all;
  for (std::size_t begin = 0; begin <= list.size();) {
    std::size_t const comma = std::min(list.find(',', begin), list.size());
    std::string const item = trimmed(list.substr(begin, comma - begin));
    begin = comma + 1;
    auto const number = leading_number(item);
    auto const unit = number ? parse_unit(number->rest) : std::nullopt;
    if (!unit || !(unit->dimension == dim::frequency))
      throw InputError(
          fmt::format("{}: '{}' is not a frequency", option, item),
          fmt::format("write {} \"10.5 Hz, 1 kHz\": a unit for each, and decimal points, not commas", option));
    if (double const hz = to_si(number->value, *unit); !(hz >= lowest_frequency && hz <= highest_frequency))
      throw InputError(fmt::format("{}: '{}' is not between 1 uHz and 1 MHz", option, item),
                       fmt::format("write {} \"10 Hz, 1 kHz\"", option));
    all.push_back(to_si(number->value, *unit));
  }
  return all;
}

void add_format_option(CLI::App& command, PrintOptions& options) {
  command.add_option("--format", options.format, "text or json")->check(CLI::IsMember({"text", "json"}));
}

void refuse_overwriting(std::string const& output, std::string const& input) {
  std::error_code none;
  bool const same = !output.empty() && std::filesystem::weakly_canonical(output, none) ==
                                           std::filesystem::weakly_canonical(input, none);  // neither may exist yet
  if (same || std::filesystem::equivalent(output, input, none))
    throw InputError(fmt::format("the output '{}' is also another file of this command", output),
                     "choose another name for the output: an input is not overwritten");
}

namespace {

// A folder that another option names, which the command makes itself.
bool is_folder_of(std::filesystem::path const& file, std::string const& value) {
  return !file.parent_path().empty() &&
         (file.parent_path() / "").lexically_normal() == (std::filesystem::path(value) / "").lexically_normal();
}

void check_output(CLI::App const& command, CLI::Option const& option, std::string const& file) {
  bool made = false;
  for (CLI::Option const* other : command.get_options()) {
    if (other == &option) continue;
    for (std::string const& value : other->results()) {
      for (char const* mark : {"", "::", "@"})  // FILE, FILE::CHANNEL, FILE@A..B
        refuse_overwriting(file, *mark ? value.substr(0, value.find(mark)) : value);
      made = made || is_folder_of(file, value);
    }
  }
  if (!made) check_writable(file);
}

}  // namespace

void mark_output(CLI::App& command, CLI::Option& option) {
  option.check(CLI::Validator(
      [&command, &option](std::string const& file) -> std::string {
        check_output(command, option, file);
        return {};
      },
      ""));
}

void drop_slashes(std::string& folder) {
  while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
}

void refuse_two_formats(bool csv, PrintOptions const& options) {
  if (csv && options.json()) throw InputError("--csv and --format json exclude each other", "choose one of them");
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides, std::string const& help) {
  auto const take = [&overrides](std::vector<std::string> const& given) {
    std::set<std::string> names;
    for (std::string const& text : given)
      if (std::string const name = text.substr(0, text.find('=')); !names.insert(name).second)
        throw InputError(fmt::format("-p sets '{}' twice", name), "keep one of them");
    overrides = given;
  };
  command.add_option_function<std::vector<std::string>>("-p,--param", take, help)->allow_extra_args(false);
}

void add_param_option(CLI::App& command, SceneOptions& options) {
  add_overrides(command, options.overrides,
                "set a parameter, for example -p rim=48cm, or any value by its place in the scene");
}

void add_scene_options(CLI::App& command, SceneOptions& options, char const* input) {
  command.add_option("scene", options.input, input)->required();
  add_param_option(command, options);
  command.add_flag("--quiet", options.quiet, "no progress, no warnings");
  add_format_option(command, options);
}

void add_history_options(CLI::App& command, TraceOptions& options) {
  command
      .add_option_function<double>(
          "--histories", [&](double n) { options.histories = std::uint64_t(n); },
          "largest number of histories, rounded up to whole blocks of 4096 (small runs: of 512, 64 or 8)")
      ->check(number_between(1, 1e12, "1e6"));
  command.add_option("--seed", options.seed, "seed of the random numbers; the same seed gives the same bits")
      ->check(whole_between(0, 9e15, "7"));
}

void add_trace_options(CLI::App& command, TraceOptions& options) {
  add_history_options(command, options);
  command
      .add_option("--until", options.until,
                  "stop rule: \"h_total < 5 %\", \"routes < 10 %\", \"receiver:PD < 5 %\", \"class:* < 10 %\", \"10 "
                  "min\", or a list; 'histories' of the scene stays the upper limit")
      ->check(readable(parse_stop_rule));
  command.add_option("--threads", options.threads, "number of threads; default: all cores; does not change the result")
      ->check(whole_between(1, 1024, "4"));
  command.add_option("--backend", options.backend,
                     "cpu; cuda: on a GPU; for trace also mpi: all processes of mpirun; histories have the same bits");
  command.add_option_function<std::string>(
      "--max-time", [&](std::string const& text) { options.max_seconds = parse_duration(text); },
      "stop after this time, for example 50min, with a result that can be resumed");
  command.add_option_function<std::string>(
      "--checkpoint",
      [&](std::string const& text) { options.checkpoint_seconds = text == "off" ? infinity : parse_duration(text); },
      "interval of checkpoints: a kill loses no more than this time; default 20min; or off");
  add_force_option(command, options.force);
}

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force, "overwrite the run of another model, or files of the library; never other files");
}

void add_live_options(CLI::App& command, LiveOptions& options, std::string const& help) {
  auto* const live = command.add_flag("--live", options.live, help);
  command.add_option("--live-port", options.port, "port of that page; default: a free one")
      ->check(whole_between(1, 65535, "8321"))
      ->needs(live);
  command.add_flag("--open", options.open, "open that page in a browser (xdg-open)")->needs(live);
}

namespace {

std::vector<std::string> words_of(CLI::App const& app) {
  std::vector<std::string> words;
  for (CLI::Option const* option : app.get_options())
    for (std::string const& name : option->get_lnames()) words.push_back("--" + name);
  for (CLI::App const* command : app.get_subcommands(nullptr)) words.push_back(command->get_name());
  return words;
}

// The word of the command line that no option takes; empty when only the command is missing.
std::string unknown_word(CLI::App const& command, CLI::App const& app) {
  for (CLI::App const* a : {&command, &app})
    for (std::string const& word : a->remaining())
      if (word.starts_with('-')) return word.substr(0, word.find('='));
  auto const rest = app.remaining(true);
  return rest.empty() ? "" : rest.front();
}

// The problem and the remedy.
struct Complaint {
  std::string what, remedy;
};

Complaint unknown_choice(std::string const& option, std::string const& word, std::string const& list) {
  std::vector<std::string> known;
  for (std::size_t at = 0; at <= list.size();) {
    std::size_t const comma = std::min(list.find(',', at), list.size());
    known.push_back(list.substr(at, comma - at));
    at = comma + 1;
  }
  std::string const near = nearest_word(word, known);
  return {fmt::format("{} cannot be '{}'", option, word),
          fmt::format("{}write one of: {}", near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                      fmt::join(known, ", "))};
}

// Of a value that a check of the option parser refuses; empty for other messages.
std::optional<Complaint> unsuitable_value(std::string const& text) {
  static Pattern const no_file(R"((.+): File does not exist: (.*))"),
      folder(R"((.+): File is actually a directory: (.*))");
  if (PatternMatch const m = no_file.match(text))
    return Complaint{fmt::format("{}: file '{}' does not exist", m[1], m[2]), "check the name and the folder"};
  if (PatternMatch const m = folder.match(text))
    return Complaint{fmt::format("{}: '{}' is a folder", m[1], m[2]), "name a file"};
  return {};
}

// Messages of the option parser in our wording; empty for others.
std::optional<Complaint> rewritten(std::string const& text, std::string const& named) {
  if (auto const value = unsuitable_value(text)) return value;
  static Pattern const twice(R"((.+): At Most (\d+) required but received (\d+))"),
      value(R"((.+): \d+ required .*missing)"), choice(R"((.+): (.*) not in \{(.*)\})"), missing(R"((.+) is required)"),
      number(R"(Could not convert: (.+) = (.*))"), few(R"((.+): At least (\d+) required but received (\d+))");
  if (PatternMatch const m = twice.match(text))
    return Complaint{fmt::format("{} appears {} times", m[1], m[3]), "give it once"};
  if (PatternMatch const m = few.match(text))
    return Complaint{fmt::format("'{}' needs {} values, but received {}", m[1], m[2], m[3]), "write all of them"};
  if (PatternMatch const m = value.match(text)) return Complaint{m[1] + " needs a value", "write it after the option"};
  if (PatternMatch const m = choice.match(text)) return unknown_choice(m[1], m[2], m[3]);
  if (PatternMatch const m = number.match(text))
    return Complaint{fmt::format("{} cannot be '{}'", m[1], m[2]), "write a number without a unit"};
  if (text == "A subcommand is required") return Complaint{"a command is missing", "write one after the name"};
  PatternMatch const m = missing.match(text);
  if (!m) return {};
  if (m[1].starts_with('-')) return Complaint{m[1] + " is missing", "add it with its value"};
  return Complaint{fmt::format("'{}' is missing", m[1]), fmt::format("write straytrace {}{}", named, m[1])};
}

std::string help_of(std::string const& named) { return fmt::format("see straytrace {}--help", named); }

// The commands that have an option, as one writes them.
std::vector<std::string> commands_with(CLI::App const& app, std::string const& option, std::string const& named = "") {
  std::vector<std::string> found;
  for (CLI::App const* command : app.get_subcommands(nullptr)) {
    std::string const name = named + command->get_name();
    if (command->get_option_no_throw(option) != nullptr) found.push_back(name);
    for (std::string const& below : commands_with(*command, option, name + " ")) found.push_back(below);
  }
  return found;
}

// Where an option belongs that this command does not have; empty where no command has it.
std::string owners_of(CLI::App const& command, std::string const& option) {
  constexpr std::size_t most = 4;
  CLI::App const* top = &command;
  while (top->get_parent() != nullptr) top = top->get_parent();
  std::vector<std::string> owners = option.starts_with("--") ? commands_with(*top, option) : std::vector<std::string>();
  if (owners.empty()) return {};
  bool const more = owners.size() > most;
  if (more) owners.resize(most);
  return fmt::format("it is an option of {}{}; ", fmt::join(owners, ", "), more ? " and others" : "");
}

InputError of_word(CLI::App const& command, std::string const& name, std::string const& named) {
  std::string const help = help_of(named);
  bool const takes_commands = !command.get_subcommands(nullptr).empty();
  auto const known = words_of(command);
  if (std::ranges::find(known, name) != known.end())
    return InputError(fmt::format("'{}' is written before its command", name),
                      fmt::format("write straytrace {}... {}; {}", named, name, help));
  std::string const near = nearest_word(name, known);
  std::string const what = name.starts_with('-') ? "an option" : takes_commands ? "a command" : "expected";
  std::string owners = owners_of(command, name);
  if (owners.empty() && !near.empty()) owners = fmt::format("did you mean '{}'? ", near);
  return InputError(fmt::format("'{}' is not {} here", name, what), owners + help);
}

InputError of_value(CLI::ParseError const& e, std::string const& named) {
  auto const ours = rewritten(e.what(), named);
  return ours ? InputError(ours->what, ours->remedy + "; " + help_of(named)) : InputError(e.what(), help_of(named));
}

// Different ones, in the order in which they are found.
struct OptionErrors {
  void add(InputError e) {
    remove(e);
    all.push_back(std::move(e));
  }
  void remove(InputError const& e) {
    std::erase_if(all, [&](InputError const& known) { return known.what() == std::string_view(e.what()); });
  }
  std::vector<InputError> all;
};

// An error in an option ends the parsing before the options behind it are checked.
void check_values(CLI::App& app, std::string const& named, OptionErrors& errors) {
  for (CLI::Option* option : app.get_options()) try {
      if (option->count() > 0 && !option->get_callback_run()) option->run_callback();
    } catch (CLI::ParseError const& e) {
      if (e.get_exit_code() != 0) errors.add(of_value(e, named));
    } catch (InputError const& e) {
      errors.add(e);
    } catch (std::exception const&) {  // of the disk: reported once the command line is right
    }
}

// A missing option is not reported where its name is only misspelt.
void check_missing(CLI::App& command, std::set<std::string> const& meant, std::string const& named,
                   OptionErrors& errors) {
  for (CLI::Option const* option : command.get_options()) {
    bool const misspelt =
        std::ranges::any_of(option->get_lnames(), [&](std::string const& name) { return meant.contains("--" + name); });
    if (!option->get_required() || option->count() > 0) continue;
    InputError const missing = of_value(CLI::RequiredError(option->get_name()), named);
    misspelt ? errors.remove(missing) : errors.add(missing);
  }
}

}  // namespace

InputError in_our_words(CLI::App const& command, CLI::App const& app, CLI::ParseError const& e,
                        std::string const& named) {
  bool const takes_commands = !command.get_subcommands(nullptr).empty();
  std::string const name =
      takes_commands || dynamic_cast<CLI::ExtrasError const*>(&e) ? unknown_word(command, app) : "";
  return name.empty() ? of_value(e, named) : of_word(command, name, named);
}

InputError with_further_errors(InputError const& first, CLI::App& app, bool complete) {
  OptionErrors errors;
  errors.add(first);
  CLI::App* command = &app;
  std::string named;
  for (;; named += command->get_name() + " ") {
    check_values(*command, named, errors);
    auto const below = command->get_subcommands();
    if (below.empty()) break;
    command = below.front();
  }
  if (command->get_require_subcommand_min() > 0) return joined(errors.all);
  std::set<std::string> meant;
  auto const known = words_of(*command);
  for (std::string const& word : app.remaining(true)) {
    if (!word.starts_with('-') || word == "--") continue;
    std::string const name = word.substr(0, word.find('='));
    meant.insert(nearest_word(name, known));
    errors.add(of_word(*command, name, named));
  }
  if (complete) check_missing(*command, meant, named, errors);
  return joined(errors.all);
}

namespace {

struct Task {
  char const* name;
  std::vector<void (*)(CLI::App&, int&)> commands;
};

std::vector<Task> const& tasks() {
  static std::vector<Task> const all = {
      {"Model", {add_check, add_print, add_inspect, add_render, add_view}},
      {"Light", {add_run, add_trace, add_importance, add_apertures, add_wave, add_ghosts, add_ifo}},
      {"Noise",
       {add_noise, add_budget, add_scan, add_sensitivity, add_optimise, add_project, add_fringes, add_sensors}},
      {"Data", {add_signal, add_couple, add_fit}},
      {"Results", {add_paths, add_maps, add_report, add_diff}},
      {"Cluster", {add_submit, add_merge}},
      {"Look-up", {add_library, add_explain, add_schema}},
  };
  return all;
}

struct OptionGroup {
  char const* name;
  std::vector<std::string> options;  // long names
};

std::vector<OptionGroup> const& groups() {
  static std::vector<OptionGroup> const all = {
      {"Model", {"param", "strict", "resolved", "migrate", "units", "entry", "angles", "beyond"}},
      {"Motion",
       {"motion", "response", "set", "body", "axis", "channel", "own-motion", "amplitude", "frequency", "duration"}},
      {"Data", {"witness",    "witness2",     "target",        "force",          "local",         "injection",
                "list",       "gps",          "unit",          "witness-unit",   "witness2-unit", "target-unit",
                "force-unit", "output-unit",  "coupling-unit", "displacement",   "corner",        "ratio",
                "wavelength", "multiplicity", "bounces",       "gain-per-field", "measured",      "sweeps",
                "length",     "before",       "rate",          "segments"}},
      {"Tracing",
       {"histories", "seed", "until", "max-time", "checkpoint", "slice", "history", "floor", "order", "detuning",
        "seam", "no-seam", "grid-check", "by-frequency", "trace", "step"}},
      {"Computing", {"threads", "backend", "jobs", "time", "accounting", "live", "live-port", "open"}},
      {"Analysis", {"invert",        "against",
                    "margin",        "per-frequency",
                    "tolerance",     "compare",
                    "delay",         "drift",
                    "free",          "train",
                    "method",        "false-alarm",
                    "factor",        "paths",
                    "retarded",      "paths-per-route",
                    "realisations",  "significance",
                    "witness-ratio", "target-ratio",
                    "force-ratio",   "accept-incoherent",
                    "threshold",     "modes",
                    "averages",      "z-max",
                    "harmonics",     "estimator",
                    "confidence",    "to",
                    "domain",        "notch",
                    "first-order",   "referred-to"}},
      {"Spectra",
       {"segment", "overlap", "window", "average", "detrend", "stride", "resolution", "points-per-decade", "power",
        "normalise", "q"}},
      {"Camera",
       {"mode", "eye", "look", "up", "fov", "pixels", "from", "cut", "flash", "lamp", "section", "whole", "beams"}},
      {"Selection",
       {"show",     "only", "band", "by",     "where",   "sort",     "without", "census", "path",     "route", "port",
        "moved-by", "beam", "at",   "points", "profile", "distance", "above",   "kind",   "pictures", "rays",  "halo"}},
      {"Output", {"out",         "csv",     "plot",   "html",   "write",   "save",   "save-motion", "subtract", "asd",
                  "spectrogram", "overlay", "export", "title",  "vtk",     "glb",    "copy",        "partial",  "force",
                  "format",      "quiet",   "silent", "events", "unsaved", "fields", "version",     "help"}},
  };
  return all;
}

bool lists(OptionGroup const& group, CLI::Option const& option) {
  return std::ranges::any_of(option.get_lnames(), [&](std::string const& name) {
    return std::ranges::find(group.options, name) != group.options.end();
  });
}

// A footer as declared: lines indented by two spaces are examples, all others are notes.
struct Footer {
  std::string examples, notes;
};

Footer parts_of(std::string const& footer) {
  Footer parts;
  std::istringstream in(footer);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("  "))
      parts.examples += line + "\n";
    else if (line != "Examples:")
      parts.notes += line + "\n";
  return parts;
}

class Layout : public CLI::Formatter {
 public:
  std::string make_help(CLI::App const* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    Footer const footer = parts_of(app->get_footer());
    std::string text = make_description(app);
    if (!footer.examples.empty()) text += "\nExamples:\n" + footer.examples;
    text += "\n" + make_usage(app, name) + make_positionals(app);
    for (std::string const& group : option_groups()) {
      auto const options = app->get_options(
          [&](CLI::Option const* option) { return option->get_group() == group && option->nonpositional(); });
      if (!options.empty()) text += make_group(group + " options", false, options);
    }
    text += make_subcommands(app, mode);
    return footer.notes.empty() ? text : text + "\n" + footer.notes;
  }
};

void lay_out(CLI::App& app, std::shared_ptr<Layout> const& layout) {
  app.formatter(layout);
  for (CLI::Option* option : app.get_options())
    if (option->nonpositional() && option->get_group() == "Options")
      for (OptionGroup const& group : groups())
        if (lists(group, *option)) option->group(group.name);
  for (CLI::App* command : app.get_subcommands(nullptr)) lay_out(*command, layout);
}

}  // namespace

void add_commands(CLI::App& app, int& exit_code) {
  for (Task const& task : tasks())
    for (auto* const add : task.commands) {
      add(app, exit_code);
      app.get_subcommands(nullptr).back()->group(task.name);
    }
}

void lay_out_help(CLI::App& app) {
  auto const layout = std::make_shared<Layout>();
  layout->column_width(30);
  lay_out(app, layout);
}

std::vector<std::string> const& option_groups() {
  static std::vector<std::string> const names = [] {
    std::vector<std::string> all;
    for (OptionGroup const& group : groups()) all.emplace_back(group.name);
    return all;
  }();
  return names;
}

}  // namespace straytrace::cli
