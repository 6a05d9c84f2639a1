#include "sim/work/code_tracker.h"

#include <algorithm>
#include <utility>

#include "sim/work/counts.h"

namespace leviosim::work {
namespace {

/// Equal hashes are compared.
std::uint64_t hash_of(std::span<const std::uint32_t> words) {
  std::uint64_t hash = words.size();
  for (const std::uint32_t word : words) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return hash;
}

template <class T>
std::size_t index(T number) {
  return static_cast<std::size_t>(number);
}

}  // namespace

void CodeTracker::select(int core) {
  states_of_cores_[core_] = state_;
  core_ = index(core);
  state_ = states_of_cores_[core_];
}

void CodeTracker::follow(const CodeWindow& window) {
  if (window.events.empty()) return;
  if (kept_ != nullptr) [[unlikely]] {
    EventsOfSegments& segments = kept_->at(core_);
    if (segments.empty()) segments.emplace_back();
    segments.back().insert(segments.back().end(), window.events.begin(), window.events.end());
  }
  std::int32_t number = first_steps_[state_];
  if (number == kNone || steps_[index(number)].window != window.hash) [[unlikely]]
    number = find_step(window);
  Step& step = steps_[index(number)];
  if (step.uses++ == 0) unsettled_.push_back(number);
  state_ = step.next_state;
}

void CodeTracker::settle() {
  if (kept_ != nullptr) [[unlikely]]
    kept_->at(core_).emplace_back();  // of the next segment
  for (const std::int32_t number : unsettled_) {
    Step& step = steps_[index(number)];
    for (std::uint32_t i = step.fetches.begin; i != step.fetches.end; ++i)
      tally.code[fetches_[i].reuse] += std::uint64_t{step.uses} * fetches_[i].bytes;
    for (std::size_t i = 0; i < step.compiled.size(); ++i)
      tally.compiled[i] += std::uint64_t{step.uses} * step.compiled[i];
    step.uses = 0;
  }
  unsettled_.clear();
}

std::int32_t CodeTracker::find_step(const CodeWindow& window) {
  std::int32_t& first = first_steps_[state_];
  std::int32_t* link = &first;
  while (*link != kNone && steps_[index(*link)].window != window.hash)
    link = &steps_[index(*link)].sibling;
  if (*link == kNone) return add_step(window);
  // To the front: loops will take it again.
  const std::int32_t found = *link;
  *link = steps_[index(found)].sibling;
  steps_[index(found)].sibling = std::exchange(first, found);
  return found;
}

std::int32_t CodeTracker::add_step(const CodeWindow& window) {
  if (places_.size() >= kMostStates) forget();
  Place place = places_[state_];
  const std::size_t first_fetch = fetches_.size();
  entered_ = {};
  for (const CodeEvent event : window.events) walk(place, event);
  merge_fetches(first_fetch);
  const auto number = static_cast<std::int32_t>(steps_.size());
  const std::uint32_t next = state_of(place);
  steps_.push_back(
      {window.hash,
       {static_cast<std::uint32_t>(first_fetch), static_cast<std::uint32_t>(fetches_.size())},
       next,
       first_steps_[state_],
       entered_});
  first_steps_[state_] = number;
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
  if (piece == CodeMap::kUnknown) {
    without_size_.insert(piece_key);
    return;
  }
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
  if (known)
    for_reuse_classes(distance, code.bytes, add);
  else
    add(kNeverFetched, code.bytes);
  if (code.again_bytes > 0) for_reuse_classes(code.bytes, code.again_bytes, add);
  for (std::size_t i = 0; i < entered_.size(); ++i) entered_[i] += code.compiled[i];
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
    if (places_[it->second] == place) return it->second;
  const auto state = static_cast<std::uint32_t>(places_.size());
  places_.push_back(place);
  first_steps_.push_back(kNone);
  state_of_hash_.emplace(hash, state);
  return state;
}

void CodeTracker::forget() {
  settle();
  states_of_cores_[core_] = state_;
  const std::vector<Place> places = std::exchange(places_, {});
  first_steps_.clear();
  steps_.clear();
  fetches_.clear();
  state_of_hash_.clear();
  for (std::uint32_t& state : states_of_cores_) state = state_of(places[state]);
  state_ = states_of_cores_[core_];
}

void CodeEvents::follow_code() {
  const CodeWindow window = code_events.take();
  if (current_code != nullptr) current_code->follow(window);
}

void fetch_code() {
  const CodeWindow window = code_events.take();
  if (current_code == nullptr) return;
  current_code->follow(window);
  current_code->settle();
}

}  // namespace leviosim::work
