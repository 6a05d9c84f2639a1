#include "sim/work/code_tracker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/work/counts.h"

namespace leviosim::work {
namespace {

/// Of 8 words at a time, in lanes that do not wait for each other. Equal hashes are compared.
std::uint64_t hash_of(std::span<const std::uint32_t> words) {
  constexpr std::array<std::uint64_t, 4> kFactors = {0x9e3779b97f4a7c15u, 0xc2b2ae3d27d4eb4fu,
                                                     0x165667b19e3779f9u, 0xd6e8feb86659fd93u};
  std::array<std::uint64_t, 4> lanes = {words.size(), 1, 2, 3};
  std::size_t i = 0;
  for (; i + 8 <= words.size(); i += 8)
    for (std::size_t k = 0; k < 4; ++k)
      lanes[k] =
          (lanes[k] ^ (words[i + 2 * k] | std::uint64_t{words[i + 2 * k + 1]} << 32)) * kFactors[k];
  for (; i < words.size(); ++i) lanes[i % 4] = (lanes[i % 4] ^ words[i]) * kFactors[i % 4];
  std::uint64_t hash = 0;
  for (const std::uint64_t lane : lanes) hash = (hash ^ lane ^ (lane >> 32)) * kFactors[0];
  return hash;
}

template <class T>
std::size_t index(T number) {
  return static_cast<std::size_t>(number);
}

}  // namespace

void CodeTracker::follow(std::span<const CodeEvent> events) {
  if (events.empty()) return;
  const std::uint64_t hash = hash_of(events);
  std::int32_t number = find_step(hash, events);
  if (number == kNone) number = add_step(hash, events);
  const Step& step = steps_[index(number)];
  for (std::uint32_t i = step.fetches.begin; i != step.fetches.end; ++i)
    tally.code[fetches_[i].reuse] += fetches_[i].bytes;
  state_ = step.next_state;
}

std::int32_t CodeTracker::find_step(std::uint64_t hash, std::span<const CodeEvent> events) {
  std::int32_t& first = states_[state_].first_step;
  std::int32_t* link = &first;
  for (; *link != kNone; link = &steps_[index(*link)].sibling) {
    const Step& step = steps_[index(*link)];
    if (step.hash == hash &&
        std::equal(events.begin(), events.end(), events_.begin() + step.events.begin,
                   events_.begin() + step.events.end))
      break;
  }
  const std::int32_t found = *link;
  if (found != kNone && found != first) {  // to the front: loops will take it again
    *link = steps_[index(found)].sibling;
    steps_[index(found)].sibling = std::exchange(first, found);
  }
  return found;
}

std::int32_t CodeTracker::add_step(std::uint64_t hash, std::span<const CodeEvent> events) {
  if (states_.size() >= kMostStates) start_from(states_[state_].place);
  Place place = states_[state_].place;
  const std::size_t first_event = events_.size(), first_fetch = fetches_.size();
  events_.insert(events_.end(), events.begin(), events.end());
  for (const CodeEvent event : events) walk(place, event);
  merge_fetches(first_fetch);
  const auto range = [](std::size_t begin, std::size_t end) {
    return Range{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  };
  const auto number = static_cast<std::int32_t>(steps_.size());
  const std::uint32_t next = state_of(place);
  steps_.push_back({hash, states_[state_].first_step, next, range(first_event, events_.size()),
                    range(first_fetch, fetches_.size())});
  states_[state_].first_step = number;
  return number;
}

void CodeTracker::walk(Place& place, CodeEvent event) {
  if (event == CodeEvents::kLeave) {
    if (place.callers.empty()) return;  // of a function entered before anyone followed
    const std::uint32_t returned = place.callers.back();
    place.callers.pop_back();
    if (!place.callers.empty()) visit(place, CodeMap::piece_key(place.callers.back(), returned));
  } else if (event < CodeName::kSmallest) {
    CodeEvents::for_each_routine(event, [&](Routine routine) {
      visit(place, CodeMap::piece_key(name_of(routine).key, CodeMap::kEntry));
    });
  } else {
    place.callers.push_back(event);
    visit(place, CodeMap::piece_key(event, CodeMap::kEntry));
  }
}

void CodeTracker::visit(Place& place, std::uint64_t piece_key) {
  const int piece = map_->find(piece_key);
  if (piece == CodeMap::kUnknown) return;
  const std::vector<CodeMap::Piece>& pieces = map_->pieces();
  const CodeMap::Piece& code = pieces[index(piece)];
  const auto number = static_cast<std::uint32_t>(piece);
  std::uint32_t distance = code.bytes;
  auto found = place.order.begin();
  for (; found != place.order.end() && *found != number; ++found) distance += pieces[*found].bytes;
  const bool known = found != place.order.end();
  if (!known) found = place.order.insert(found, number);
  std::rotate(place.order.begin(), found, found + 1);
  const auto add = [this](std::size_t reuse, std::uint32_t bytes) {
    fetches_.push_back({static_cast<std::uint32_t>(reuse), bytes});
  };
  add(known ? reuse_class(distance) : kNeverFetched, code.bytes);
  if (code.again_bytes > 0) add(reuse_class(code.bytes), code.again_bytes);
}

void CodeTracker::merge_fetches(std::size_t first) {
  const auto begin = fetches_.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, fetches_.end(),
            [](const Fetch& a, const Fetch& b) { return a.reuse < b.reuse; });
  auto last = begin;
  for (auto it = begin; it != fetches_.end(); ++it) {
    if (it == last) continue;
    if (it->reuse == last->reuse)
      last->bytes += it->bytes;
    else
      *++last = *it;
  }
  if (last != fetches_.end()) fetches_.erase(last + 1, fetches_.end());
}

std::uint32_t CodeTracker::state_of(const Place& place) {
  const std::uint64_t hash = hash_of(place.order) ^ hash_of(place.callers);
  const auto [begin, end] = state_of_hash_.equal_range(hash);
  for (auto it = begin; it != end; ++it)
    if (states_[it->second].place == place) return it->second;
  const auto state = static_cast<std::uint32_t>(states_.size());
  states_.push_back({kNone, place});
  state_of_hash_.emplace(hash, state);
  return state;
}

void CodeTracker::start_from(Place place) {
  states_.clear();
  steps_.clear();
  events_.clear();
  fetches_.clear();
  state_of_hash_.clear();
  state_ = state_of(place);
}

void CodeEvents::follow_code() { fetch_code(); }

void fetch_code() {
  const std::span<const CodeEvent> events = code_events.take();
  if (current_code != nullptr) current_code->follow(events);
}

}  // namespace leviosim::work
