#pragma once

namespace fathom {

class Session;

/// A tool that shows what it would draw, step by step, before that becomes part of the exam.
class StepTool {
 public:
  virtual ~StepTool() = default;
  /// Takes back the last step. False where there is none.
  virtual bool undo(Session& session) = 0;
  /// Puts what is shown into the exam, as one action.
  virtual void finish(Session& session) = 0;
  /// Drops what is shown.
  virtual void give_up(Session& session) = 0;
};

}  // namespace fathom
