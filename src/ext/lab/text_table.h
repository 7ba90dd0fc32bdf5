#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace pbrt::lab {

/// Rows as text in columns that are wide enough for their entries; the first is aligned left, the others right.
inline std::string Align(const std::vector<std::vector<std::string>> &rows) {
    std::vector<size_t> width(rows.at(0).size(), 0);
    for (const auto &row : rows)
        for (size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (const auto &row : rows) {
        for (size_t c = 0; c < row.size(); ++c)
            text += c == 0 ? fmt::format("{:<{}}", row[c], width[c]) : fmt::format("  {:>{}}", row[c], width[c]);
        text += "\n";
    }
    return text;
}

/// A name as an entry of a CSV file. Names hold no quotation marks.
inline std::string Quoted(const std::string &text) {
    return text.find_first_of(",\"") == std::string::npos ? text : "\"" + text + "\"";
}

}  // namespace pbrt::lab
