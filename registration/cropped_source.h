#pragma once

#include <memory>
#include <string>

#include "acquisition/live/live_source.h"
#include "registration/image_preset.h"

namespace fathom {

/// A source of which only the part that a preset keeps is used. Pixels are not copied: its images are views of the
/// whole ones.
///
/// The first image must have the preset's size, or the source fails and says so. Where a later one has not, the
/// scanner's setting was changed: such images are passed on whole, with the status "INVALID".
class CroppedSource : public LiveSource, private LiveListener {
 public:
  /// Throws Error where the preset is not one.
  CroppedSource(std::unique_ptr<LiveSource> source, ImagePreset preset);

  const std::string& name() const override { return source_->name(); }
  void start(LiveListener& listener) override;
  void stop() override { source_->stop(); }

 private:
  void on_frame(LiveFrame frame) override;
  void on_sample(TrackerSample sample) override;
  void on_event(SourceEvent event) override;

  std::unique_ptr<LiveSource> source_;
  ImagePreset preset_;
  LiveListener* listener_ = nullptr;
  bool fitted_ = false;  // an image has had the preset's size
  bool failed_ = false;
};

}  // namespace fathom
