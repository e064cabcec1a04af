#include "registration/cropped_source.h"

#include <utility>

#include "core/printable.h"

namespace fathom {

CroppedSource::CroppedSource(std::unique_ptr<LiveSource> source, ImagePreset preset)
    : source_(std::move(source)), preset_(std::move(preset)) {
  preset_.check();
}

void CroppedSource::start(LiveListener& listener) {
  listener_ = &listener;
  source_->start(*this);
}

void CroppedSource::on_frame(LiveFrame frame) {
  if (failed_) return;
  if (frame.image.size() == preset_.image_size) {
    fitted_ = true;
    frame.image = cropped(frame.image, preset_);
  } else if (fitted_) {
    frame.status = "INVALID";
  } else {
    failed_ = true;
    const auto text = [](const cv::Size& size) {
      return std::to_string(size.width) + " x " + std::to_string(size.height);
    };
    return listener_->on_event({SourceState::kFailed, live_clock_s(),
                                printable(name(), 300) + ": its images have " + text(frame.image.size()) +
                                    " pixels, those of preset \"" + printable(preset_.name, 100) + "\" " +
                                    text(preset_.image_size) + "; choose the preset of the scanner's setting"});
  }
  listener_->on_frame(std::move(frame));
}

void CroppedSource::on_sample(TrackerSample sample) { listener_->on_sample(std::move(sample)); }

void CroppedSource::on_event(SourceEvent event) {
  if (!failed_) listener_->on_event(std::move(event));
}

}  // namespace fathom
