#include "relumbre/archsim/cache.h"

#include <algorithm>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

const CacheConfig& checked(const CacheConfig& config) {
  if (config.lines == 0 || config.lines > CacheConfig::kMaxLines)
    throw ValueError(fmt::format("a cache of {} lines: it must have 1 to {}", config.lines,
                                 CacheConfig::kMaxLines));
  if (config.ways == 0 || config.lines % config.ways != 0)
    throw ValueError(fmt::format("a cache of {} lines in sets of {}: they must divide it evenly",
                                 config.lines, config.ways));
  return config;
}

std::variant<SearchedSets, HashedSet> store_for(const CacheConfig& config) {
  if (config.ways > 1 && config.ways == config.lines) return HashedSet(config);
  return SearchedSets(config);
}

}  // namespace

CacheCounters& CacheCounters::operator+=(const CacheCounters& other) {
  reads += other.reads;
  hits += other.hits;
  replacements += other.replacements;
  lines_used += other.lines_used;
  return *this;
}

SearchedSets::SearchedSets(const CacheConfig& config)
    : ways_(config.ways),
      sets_(config.lines / config.ways),
      replacement_(config.replacement),
      random_(config.seed),
      tags_(config.lines),
      used_(sets_) {}

CacheOutcome SearchedSets::read(std::uint64_t address) {
  const auto set = static_cast<std::size_t>(address % sets_);
  std::uint64_t* const first = tags_.data() + set * ways_;
  std::uint64_t* const last = first + used_[set];
  std::uint64_t* const found = std::find(first, last, address);
  if (found != last) {
    if (replacement_ == Replacement::kLru) std::rotate(first, found, found + 1);
    return CacheOutcome::kHit;
  }
  const bool is_full = used_[set] == ways_;
  if (is_full && replacement_ == Replacement::kRandom) {
    first[random_.bits() % ways_] = address;
    return CacheOutcome::kReplaced;
  }
  std::move_backward(first, is_full ? last - 1 : last, is_full ? last : last + 1);
  *first = address;
  if (is_full) return CacheOutcome::kReplaced;
  ++used_[set];
  return CacheOutcome::kFilled;
}

HashedSet::HashedSet(const CacheConfig& config)
    : lines_(config.lines), replacement_(config.replacement), random_(config.seed), entries_(1) {}

void HashedSet::unlink(Line line) {
  const Entry& entry = entries_[line];
  entries_[entry.newer].older = entry.older;
  entries_[entry.older].newer = entry.newer;
}

void HashedSet::put_first(Line line) {
  const Line second = entries_[0].older;
  entries_[line].newer = 0;
  entries_[line].older = second;
  entries_[second].newer = line;
  entries_[0].older = line;
}

HashedSet::Line HashedSet::victim() {
  if (replacement_ != Replacement::kRandom) return entries_[0].newer;  // the oldest
  return static_cast<Line>(1 + random_.bits() % lines_);
}

CacheOutcome HashedSet::read(std::uint64_t address) {
  if (const Line* line = line_of_.find(address)) {
    if (replacement_ == Replacement::kLru) unlink(*line), put_first(*line);
    return CacheOutcome::kHit;
  }
  const bool is_full = entries_.size() == lines_ + 1;
  const Line line = is_full ? victim() : static_cast<Line>(entries_.size());
  if (is_full) {
    line_of_.erase(entries_[line].address);
    unlink(line);
  } else {
    entries_.emplace_back();
  }
  entries_[line].address = address;
  put_first(line);
  line_of_.insert(address, line);
  return is_full ? CacheOutcome::kReplaced : CacheOutcome::kFilled;
}

Cache::Cache(const CacheConfig& config) : store_(store_for(checked(config))) {}

CacheOutcome Cache::read(std::uint64_t address) {
  const CacheOutcome outcome =
      std::visit([address](auto& store) { return store.read(address); }, store_);
  ++counters_.reads;
  counters_.hits += outcome == CacheOutcome::kHit;
  counters_.replacements += outcome == CacheOutcome::kReplaced;
  counters_.lines_used += outcome == CacheOutcome::kFilled;
  return outcome;
}

}  // namespace relumbre
