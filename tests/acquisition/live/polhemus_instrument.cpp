#include "tests/acquisition/live/polhemus_instrument.h"

#include <cstdio>

#include "tests/acquisition/live/polhemus_bytes.h"

namespace fathom {

void PolhemusInstrument::power_on() {
  format_ = {model_, true, 25.4, false};
  list_known_ = streaming_ = false;
  frame_ = 0;
  heard_.clear();
  sent.clear();
}

std::string PolhemusInstrument::hear(std::string_view bytes) {
  std::string said;
  for (const char c : bytes) {
    const bool fastrak = model_ == PolhemusModel::kFastrak;
    // Commands of one letter act at once; others end with a carriage return.
    if (fastrak && heard_.empty() && std::string_view("FfUuCcSP").find(c) != std::string_view::npos) {
      said += obey_fastrak(c);
    } else if (!fastrak && heard_.empty() && c == 'P') {
      streaming_ = false;
    } else if (c == '\r') {
      said += obey(heard_);
      heard_.clear();
    } else {
      heard_ += c;
    }
  }
  return answers ? said : "";
}

std::string PolhemusInstrument::obey_fastrak(char letter) {
  if (letter == 'F' || letter == 'f') format_.text = letter == 'F';
  if (letter == 'U' || (letter == 'u' && takes_centimetres)) format_.unit_mm = letter == 'u' ? 10.0 : 25.4;
  if (letter == 'C' || letter == 'c') streaming_ = letter == 'C';
  if (letter != 'S') return "";
  const int flags = 0x3f0 | (streaming_ ? 8 : 0) | (format_.unit_mm == 10.0 ? 2 : 0) | (format_.text ? 0 : 1);
  char record[80];
  std::snprintf(record, sizeof record, "21S%3X    F31  2.4.18%32s\r\n", static_cast<unsigned>(flags), "");
  return record;
}

std::string PolhemusInstrument::tagged_answer(char command, int error_code, const std::string& content) const {
  if (format_.text) return "00" + std::string(1, command) + (error_code ? "*" : " ") + content + "\r\n";
  std::string bytes = model_ == PolhemusModel::kPatriot ? "PA" : "LY";
  bytes += {1, command, static_cast<char>(error_code), 0, static_cast<char>(content.size()), 0};
  return bytes + content;
}

bool PolhemusInstrument::set_list(const std::string& command) {
  const std::string list = command.substr(std::min(command.find(','), command.size()));
  if (model_ == PolhemusModel::kFastrak) {
    list_known_ = list == ",52,61,1" || list == ",2,11,1";
    return list_known_;
  }
  format_.distortion = list.starts_with(",8,9,11");
  if (format_.distortion && !knows_distortion) return false;
  list_known_ = list.starts_with(format_.distortion ? ",8,9,11,2,7," : ",8,9,2,7,");
  return list_known_;
}

std::string PolhemusInstrument::obey(const std::string& command) {
  constexpr int kInvalid = 3;
  if (command.empty()) return "";
  const bool fastrak = model_ == PolhemusModel::kFastrak;
  if (command[0] == 'O') {
    if (set_list(command)) return "";
    return fastrak ? "2 E*ERROR* invalid list *EC-1*\r\n" : tagged_answer('O', kInvalid, "");
  }
  if (fastrak) return "2 E*ERROR* invalid command *EC-1*\r\n";
  const bool text_before = format_.text;
  if (command == "F0" || command == "F1") return format_.text = command == "F0", "";
  if (command == "U1" && takes_centimetres) return format_.unit_mm = 10.0, "";
  if (command == "U1" || command == "U0") return "";
  if (command == "U") {
    const bool centimetres = format_.unit_mm == 10.0;
    return tagged_answer('U', 0,
                         text_before ? (centimetres ? "1" : "0") : std::string(1, centimetres) + std::string(3, 0));
  }
  if (command == "C") return streaming_ = true, "";
  if (command == "\x16")
    return tagged_answer('\x16', 0, model_ == PolhemusModel::kPatriot ? "Patriot 1.2" : "Liberty 240/8");
  return tagged_answer(command[0], kInvalid, "");
}

std::string PolhemusInstrument::measure() {
  if (!streaming_) return "";
  std::string bytes;
  ++frame_;
  for (int station = 1; station <= stations; ++station) {
    PolhemusReading reading = random_reading(random_, station, frame_);
    reading.error = error;
    reading.distortion = distortion;
    bytes += list_known_ ? polhemus_bytes(reading, format_) : "01  some other list\r\n";
    sent.push_back(reading);
  }
  return answers ? bytes : "";
}

}  // namespace fathom
