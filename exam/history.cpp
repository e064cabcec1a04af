#include "exam/history.h"

#include <utility>

namespace fathom {

History::History(std::size_t budget_bytes, std::vector<Item> edits, std::size_t done)
    : budget_bytes_(budget_bytes), edits_(std::move(edits)), done_(done) {
  for (const Item& edit : edits_) bytes_ += size_bytes(*edit);
  keep_to_budget();
}

void History::push(Item edit) {
  while (edits_.size() > done_) {
    bytes_ -= size_bytes(*edits_.back());
    edits_.pop_back();
  }
  bytes_ += size_bytes(*edit);
  edits_.push_back(std::move(edit));
  ++done_;
  keep_to_budget();
}

void History::keep_to_budget() {
  std::size_t forget = 0;
  // The last one can always be undone.
  while (bytes_ > budget_bytes_ && forget + 1 < done_) bytes_ -= size_bytes(*edits_[forget++]);
  if (forget == 0) return;
  base_ = edits_[forget - 1];
  edits_.erase(edits_.begin(), edits_.begin() + static_cast<std::ptrdiff_t>(forget));
  done_ -= forget;
}

}  // namespace fathom
