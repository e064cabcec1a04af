#include "exam/anonymous.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "core/error.h"

namespace fathom {

namespace {

RecordingHeader bare(RecordingHeader header) {
  header.fields.clear();
  header.warnings.clear();
  for (FrameHeader& frame : header.frames) frame.fields.clear();
  return header;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  if (what.empty()) return;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

}  // namespace

Exam without_names(const Exam& exam) {
  Exam bare_exam = exam;
  bare_exam.patient.clear();
  bare_exam.operator_name.clear();
  bare_exam.date.clear();
  bare_exam.notes.clear();
  bare_exam.document = nullptr;
  return bare_exam;
}

std::string without_file_names(std::string text, const DocumentSnapshot& document) {
  for (std::size_t i = 0; i < document.recordings.size(); ++i) {
    const std::string by = "recording " + std::to_string(i + 1);
    replace_all(text, document.scan->recordings[i]->name(), by);
    replace_all(text, document.recordings[i].string(), by);
    replace_all(text, document.recordings[i].filename().string(), by);
  }
  if (!document.exam.folder.empty()) {
    replace_all(text, exam_json(document.exam).string(), "exam");
    replace_all(text, document.exam.folder.string() + "/", "exam/");
  }
  return text;
}

MaskedRecording::MaskedRecording(const Recording& recording, const SafeArea& area, std::string name)
    : Recording(std::move(name), bare(recording.header())), recording_(recording) {
  if (!header_.has_images()) return;
  const cv::Size size(header_.width, header_.height);
  if (area.clip.empty() || (area.clip & cv::Rect({}, size)) != area.clip) {
    fail("the area to show does not lie within the images of " + std::to_string(size.width) + " x " +
         std::to_string(size.height) + " pixels; give another");
  }
  area_ = pixel_area(size, area.clip, area.fan);
}

cv::Mat MaskedRecording::image(int frame) const {
  const cv::Mat whole = recording_.image(frame);
  cv::Mat masked = cv::Mat::zeros(whole.size(), whole.type());
  const std::size_t pixel = whole.elemSize();
  for (int y = 0; y < whole.rows; ++y) {
    for (const PixelSpan& span : area_.rows[static_cast<std::size_t>(y)]) {
      const std::size_t first = static_cast<std::size_t>(span.first) * pixel;
      std::memcpy(masked.ptr(y) + first, whole.ptr(y) + first, static_cast<std::size_t>(span.end - span.first) * pixel);
    }
  }
  return masked;
}

}  // namespace fathom
