#pragma once

#include <string>

namespace saw_ndt {

/// A text with the characters that mean something to HTML escaped.
std::string htmlEscaped(const std::string& text);

/// Bytes in base64 (RFC 4648), padded.
std::string base64(const std::string& bytes);

}  // namespace saw_ndt
