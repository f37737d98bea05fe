// SPDX-License-Identifier: BSD-3-Clause
#include "session/jobs/merge_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "session/jobs/job_files.hpp"
#include "session/session.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t lines_shown = 20;

std::vector<InputError> disagreements(std::vector<PartHead> const& heads) {
  std::vector<InputError> errors;
  auto const complain = [&](std::string what, std::string remedy) {
    errors.emplace_back(std::move(what), std::move(remedy));
  };
  PartHead const& first = heads.front();
  for (PartHead const& head : heads) {
    if (errors.size() == lines_shown) break;
    try {
      require_this_program(head.provenance, head.file, "merge with that version, or trace again with this one");
    } catch (InputError const& e) {
      errors.push_back(e);
    }
    if (head.model_hash != first.model_hash)
      complain(fmt::format("'{}' has another model than '{}'", head.file, first.file),
               "remove one of them; straytrace diff shows the difference");
    else if (head.seed != first.seed)
      complain(fmt::format("'{}' has seed {}, '{}' has seed {}: their histories differ", head.file, head.seed,
                           first.file, first.seed),
               "leave one of them out");
    else if (head.block_size != first.block_size)
      complain(fmt::format("'{}' and '{}' are parts of runs with different numbers of histories: blocks of {} and {}",
                           head.file, first.file, head.block_size, first.block_size),
               "leave one of them out");
  }
  return errors;
}

std::string name_of(BlockRange const& range) {
  return range.size() == 1 ? fmt::format("block {}", range.first)
                           : fmt::format("blocks {} to {}", range.first, range.end - 1);
}

struct Held {
  BlockRange range;
  std::size_t part;
};
std::vector<Held> held_by(std::vector<PartHead> const& heads) {
  std::vector<Held> all;
  for (std::size_t i = 0; i < heads.size(); ++i)
    for (BlockRange const& range : heads[i].done) all.push_back({range, i});
  std::sort(all.begin(), all.end(), [](Held const& a, Held const& b) {
    return a.range.first != b.range.first ? a.range.first < b.range.first : a.part < b.part;
  });
  return all;
}

std::vector<InputError> overlaps(std::vector<PartHead> const& heads) {
  std::vector<InputError> errors;
  Held const* reaches = nullptr;  // furthest so far
  std::vector<Held> const all = held_by(heads);
  for (Held const& held : all) {
    if (reaches && held.range.first < reaches->range.end && errors.size() < lines_shown)
      errors.emplace_back(fmt::format("'{}' and '{}' both contain {}", heads[reaches->part].file, heads[held.part].file,
                                      name_of({held.range.first, std::min(held.range.end, reaches->range.end)})),
                          "leave one of them out");
    if (!reaches || held.range.end > reaches->range.end) reaches = &held;
  }
  return errors;
}

std::vector<BlockRange> gaps(std::vector<PartHead> const& heads, std::uint64_t all_blocks) {
  std::vector<BlockRange> missing;
  std::uint64_t next = 0;
  for (Held const& held : held_by(heads)) {
    if (held.range.first > next) missing.push_back({next, held.range.first});
    next = std::max(next, held.range.end);
  }
  if (next < all_blocks) missing.push_back({next, all_blocks});
  return missing;
}

// The slices that hold a missing block, when all parts are slices of one division; by number.
std::vector<std::uint64_t> missing_slices(RunParts const& parts) {
  Slice const division = parts.heads.front().slice;
  for (PartHead const& head : parts.heads)
    if (head.slice.of != division.of || head.all_blocks != parts.all_blocks || division.whole()) return {};
  std::vector<std::uint64_t> numbers;
  std::uint64_t number = 1;
  for (BlockRange const& gap : parts.missing)
    for (; number <= division.of; ++number) {
      BlockRange const blocks = Slice{number, division.of}.blocks(parts.all_blocks);
      if (blocks.first >= gap.end) break;
      if (blocks.end > gap.first && blocks.size() > 0 && (numbers.empty() || numbers.back() != number))
        numbers.push_back(number);
      if (blocks.end > gap.end) break;
    }
  return numbers;
}

// "part007.h5" of part 7 becomes "part012.h5" of part 12.
std::string file_like(PartHead const& head, std::uint64_t number) {
  std::filesystem::path const path(head.file);
  std::string name = path.filename().string();
  std::size_t const end = name.find_last_of("0123456789");
  std::size_t begin = end == name.npos ? 0 : end + 1;
  while (begin > 0 && name[begin - 1] >= '0' && name[begin - 1] <= '9') --begin;
  std::string const digits = end == name.npos ? "" : name.substr(begin, end + 1 - begin);
  if (!digits.empty() && digits.size() < 10 && std::stoull(digits) == head.slice.number)
    name.replace(begin, digits.size(), fmt::format("{:0{}}", number, digits.size()));
  else
    name = fmt::format("part{}.h5", number);
  return (path.parent_path() / name).string();
}

// "3, 9 to 12, 200"
std::string runs_of(std::vector<std::uint64_t> const& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format(" to {}", numbers[last]);
    i = last;
  }
  return text;
}

// Started slices are resumed; missing ones are traced from the model in another part.
std::vector<std::string> commands(RunParts const& parts, std::vector<std::uint64_t> const& slices) {
  std::map<std::uint64_t, PartHead const*> there;
  for (PartHead const& head : parts.heads) there[head.slice.number] = &head;
  PartHead const& model = parts.heads.front();
  std::vector<std::string> lines;
  for (std::uint64_t const number : slices)
    if (auto const begun = there.find(number); begun != there.end())
      lines.push_back(fmt::format("straytrace trace {}", shell_word(begun->second->file)));
    else
      lines.push_back(fmt::format("straytrace trace {} --slice {}/{} -o {}", shell_word(model.file), number,
                                  model.slice.of, shell_word(file_like(model, number))));
  return lines;
}

std::string listed(std::vector<std::string> const& lines) {
  std::string text;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_shown); ++i) text += "  " + lines[i] + '\n';
  if (lines.size() > lines_shown) text += fmt::format("  ... and {} more\n", lines.size() - lines_shown);
  return text;
}

}  // namespace

RunParts read_parts(std::vector<std::string> const& files) {
  RunParts parts;
  std::vector<InputError> errors;
  for (std::string const& file : files) try {
      parts.heads.push_back(read_part_head(file));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  throw_all(errors);
  throw_all(disagreements(parts.heads));
  throw_all(overlaps(parts.heads));
  auto const first = [](PartHead const& head) { return head.done.empty() ? ~0ull : head.done.front().first; };
  std::stable_sort(parts.heads.begin(), parts.heads.end(),
                   [&](PartHead const& a, PartHead const& b) { return first(a) < first(b); });
  for (PartHead const& head : parts.heads) parts.all_blocks = std::max(parts.all_blocks, head.all_blocks);
  parts.missing = gaps(parts.heads, parts.all_blocks);
  return parts;
}

std::vector<BlockRange> lost_with(PartHead const& there, RunParts const& parts) {
  std::vector<BlockRange> lost;
  std::uint64_t const end = there.done.empty() ? 0 : there.done.back().end;
  for (BlockRange const& gap : gaps(parts.heads, std::max(parts.all_blocks, end)))
    for (BlockRange const& range : there.done) {
      BlockRange const both{std::max(gap.first, range.first), std::min(gap.end, range.end)};
      if (both.first < both.end) lost.push_back(both);
    }
  return lost;
}

std::string missing_text(RunParts const& parts) {
  std::uint64_t blocks = 0;
  std::vector<std::string> ranges;
  for (BlockRange const& gap : parts.missing) {
    blocks += gap.size();
    ranges.push_back(name_of(gap));
  }
  std::string text = fmt::format("{} of {} of histories {} missing\n{}", blocks, counted(parts.all_blocks, "block"),
                                 blocks == 1 ? "is" : "are", listed(ranges));
  std::vector<std::uint64_t> const slices = missing_slices(parts);
  if (slices.empty()) return text;
  return text + fmt::format("of slices {} of {}; to trace them:\n{}", runs_of(slices), parts.heads.front().slice.of,
                            listed(commands(parts, slices)));
}

SumTree merged_sums(RunParts const& parts) {
  SumTree tree;
  for (PartHead const& head : parts.heads) {
    SumTree const part = read_part_sums(head.file);
    for (auto const& [place, sums] : part.nodes()) tree.add(place.second, place.first >> place.second, sums);
  }
  return tree;
}

}  // namespace straytrace::session
