#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ext::lab {
using Json = nlohmann::ordered_json;

/// Formats rows as a table: first column left-aligned, others right-aligned.
std::string Align(const std::vector<std::vector<std::string>> &rows);

/// A name as a CSV field. Names must not contain quotation marks.
inline std::string Quoted(const std::string &text) {
    return text.find_first_of(",\"") == std::string::npos ? text : "\"" + text + "\"";
}

/// Head of a page without external resources; title and style follow.
inline constexpr const char *kPageHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
)";

/// Creates the folder if needed, and checks that files can be written there. Throws UserError.
void MakeFolder(const std::string &folder);

std::string EscapeHtml(std::string text);

Json DescribeMachine();  ///< cpu, threads, memoryGB and os of this machine; null if unknown
std::string DateText();  ///< current UTC time, as 2026-11-21T03:00:00Z

}  // namespace ext::lab
