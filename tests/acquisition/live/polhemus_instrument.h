#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/live/polhemus_record.h"
#include "core/random.h"

namespace fathom {

/// What a FASTRAK, PATRIOT or LIBERTY says to commands, and the records that it sends, as documented. Knows nothing of
/// the line; used by one thread.
class PolhemusInstrument {
 public:
  explicit PolhemusInstrument(PolhemusModel model) : model_(model) { power_on(); }

  /// As after switching on: inches, text, silent.
  void power_on();
  /// What it answers to commands; they may come in any pieces.
  std::string hear(std::string_view bytes);
  /// The records of its next measurement; empty unless it was told to send.
  std::string measure();

  // How it is built or broken; to be set before it is used.
  int stations = 2;
  bool knows_distortion = true;   ///< else it refuses a list with it
  bool takes_centimetres = true;  ///< else it stays with inches
  bool answers = true;
  int error = 0;       ///< in its records
  int distortion = 0;  ///< in its records

  /// All that it has sent since it was switched on.
  std::vector<PolhemusReading> sent;

 private:
  std::string obey(const std::string& command);
  std::string obey_fastrak(char letter);
  std::string tagged_answer(char command, int error_code, const std::string& content) const;
  bool set_list(const std::string& command);

  PolhemusModel model_;
  PolhemusFormat format_;
  bool list_known_ = false;  ///< whether it was told the list that polhemus_bytes() makes
  bool streaming_ = false;
  std::uint32_t frame_ = 0;
  std::string heard_;
  Random random_{11};
};

}  // namespace fathom
