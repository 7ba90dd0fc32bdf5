#pragma once
#include <string>

namespace pbrt::lab {

/// Text as it stands in an HTML page or in the value of an attribute.
inline std::string EscapeHtml(const std::string &text) {
    std::string out;
    for (const char c : text) switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    return out;
}

}  // namespace pbrt::lab
