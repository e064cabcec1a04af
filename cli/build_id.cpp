#include "cli/build_id.h"

#include <cstddef>
#include <cstring>

#include <elf.h>
#include <link.h>

namespace fathom {

namespace {

std::string hexadecimal(const unsigned char* bytes, std::size_t count) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += kDigits[bytes[i] >> 4];
    text += kDigits[bytes[i] & 15];
  }
  return text;
}

// Notes are a head, a name and a content, each padded to four bytes.
std::string id_in_notes(const unsigned char* notes, std::size_t size) {
  const auto padded = [](std::size_t bytes) { return (bytes + 3) / 4 * 4; };
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) head;
    std::memcpy(&head, notes, sizeof head);
    const std::size_t content = sizeof head + padded(head.n_namesz);
    const std::size_t next = content + padded(head.n_descsz);
    if (next > size) break;
    if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == 4 && std::memcmp(notes + sizeof head, "GNU", 4) == 0) {
      return hexadecimal(notes + content, head.n_descsz);
    }
    notes += next;
    size -= next;
  }
  return "";
}

}  // namespace

std::string build_id() {
  std::string id;
  const auto look = [](dl_phdr_info* object, std::size_t, void* found) {
    for (int i = 0; i < object->dlpi_phnum; ++i) {
      const auto& segment = object->dlpi_phdr[i];
      if (segment.p_type != PT_NOTE) continue;
      const auto* notes = reinterpret_cast<const unsigned char*>(object->dlpi_addr + segment.p_vaddr);
      auto& text = *static_cast<std::string*>(found);
      if (text.empty()) text = id_in_notes(notes, segment.p_memsz);
    }
    return 1;  // the first object is the program itself; its libraries do not count
  };
  ::dl_iterate_phdr(look, &id);
  return id;
}

}  // namespace fathom
