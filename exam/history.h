#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "exam/edit.h"

namespace fathom {

/// Edits done, and undone ones that may be done again, within a memory budget: the oldest are forgotten.
class History {
 public:
  using Item = std::shared_ptr<const Edit>;

  explicit History(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}
  /// As it was saved: the first `done` of `edits` are done.
  History(std::size_t budget_bytes, std::vector<Item> edits, std::size_t done);

  /// What was done last; those undone are forgotten.
  void push(Item edit);
  /// The edit to undo or to do again; empty where there is none.
  Item to_undo() const { return done_ > 0 ? edits_[done_ - 1] : nullptr; }
  Item to_redo() const { return done_ < edits_.size() ? edits_[done_] : nullptr; }
  /// Goes back over to_undo, or forward over to_redo, which must be there.
  void step_back() { --done_; }
  void step_forward() { ++done_; }

  /// Tells states apart: the last edit that led here, perhaps a forgotten one; empty at the start.
  const Item& state() const { return done_ > 0 ? edits_[done_ - 1] : base_; }

  const std::vector<Item>& edits() const { return edits_; }
  std::size_t done() const { return done_; }
  std::size_t bytes() const { return bytes_; }

 private:
  void keep_to_budget();

  std::size_t budget_bytes_ = 0;
  std::vector<Item> edits_;
  std::size_t done_ = 0;
  std::size_t bytes_ = 0;
  Item base_;  ///< the last that was forgotten
};

}  // namespace fathom
