#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// A text as it stands in HTML, whatever characters it holds.
std::string html_text(std::string_view text);

/// Rows as a table, the first as its head. What is in the cells is made safe here.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// A picture inside of the page: the bytes of a file of this type, such as "image/png".
std::string html_image(std::string_view type, std::span<const unsigned char> file, std::string_view description);

/// RFC 4648.
std::string base64(std::span<const unsigned char> bytes);

}  // namespace fathom
