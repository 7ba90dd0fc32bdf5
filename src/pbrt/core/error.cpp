#include "pbrt/core/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace pbrt {

namespace {

struct Excerpt {
    std::string text;
    size_t caret = 0;
};

/// The line `loc` points into, tabs as single blanks, cut to about 100 characters around the column.
Excerpt QuoteLine(const FileLoc &loc) {
    const std::string &text = loc.file->text;
    size_t begin = 0;
    for (int line = 1; line < loc.line; ++line) {
        size_t newline = text.find('\n', begin);
        if (newline == std::string::npos) return {};
        begin = newline + 1;
    }
    size_t end = text.find('\n', begin);
    std::string line = text.substr(begin, end == std::string::npos ? end : end - begin);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    for (char &c : line)
        if (static_cast<unsigned char>(c) < 32) c = ' ';
    size_t caret = std::min(static_cast<size_t>(std::max(0, loc.column)), line.size());
    constexpr size_t kWidth = 100;
    if (line.size() > kWidth) {
        size_t from = caret > kWidth / 2 ? std::min(caret - kWidth / 2, line.size() - kWidth) : 0;
        std::string cut = line.substr(from, kWidth);
        caret -= from;
        if (from > 0) {
            cut = "..." + cut;
            caret += 3;
        }
        if (from + kWidth < line.size()) cut += "...";
        line = cut;
    }
    return {line, caret};
}

size_t EditDistance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            size_t substitute = diagonal + (std::tolower(a[i - 1]) == std::tolower(b[j - 1]) ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
        }
    }
    return row[b.size()];
}

std::string Summarize(const std::vector<Diagnostic> &diagnostics) {
    std::string all;
    for (const Diagnostic &d : diagnostics) {
        if (!all.empty()) all += '\n';
        all += Format(d);
    }
    return all;
}

}  // namespace

std::string Format(const Diagnostic &d, bool color) {
    const char *word = d.severity == Severity::Error ? "Error" : "Warning";
    std::string out = color ? fmt::format("\033[1;31m{}\033[0m: ", word) : fmt::format("{}: ", word);
    if (d.loc.file) {
        out += d.loc.file->name;
        if (d.loc.line > 0) out += fmt::format(":{}:{}", d.loc.line, d.loc.column);
        out += ": ";
    }
    out += d.message;
    if (d.loc) {
        Excerpt e = QuoteLine(d.loc);
        if (!e.text.empty()) out += fmt::format("\n    {}\n    {}^", e.text, std::string(e.caret, ' '));
    }
    return out;
}

UserError::UserError(std::string message, FileLoc loc)
    : UserError(std::vector<Diagnostic>{{Severity::Error, std::move(loc), std::move(message)}}) {}

UserError::UserError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(Summarize(diagnostics)), diagnostics_(std::move(diagnostics)) {}

void DiagnosticSink::Error(const FileLoc &loc, std::string message) {
    diagnostics_.push_back({Severity::Error, loc, std::move(message)});
    ++errorCount_;
}

void DiagnosticSink::Warning(const FileLoc &loc, std::string message) {
    diagnostics_.push_back({Severity::Warning, loc, std::move(message)});
}

void DiagnosticSink::Add(const UserError &e) {
    for (const Diagnostic &d : e.Diagnostics()) {
        diagnostics_.push_back(d);
        if (d.severity == Severity::Error) ++errorCount_;
    }
}

void DiagnosticSink::ThrowIfErrors() const {
    if (!HasErrors()) return;
    std::vector<Diagnostic> errors;
    std::copy_if(diagnostics_.begin(), diagnostics_.end(), std::back_inserter(errors),
                 [](const Diagnostic &d) { return d.severity == Severity::Error; });
    throw UserError(std::move(errors));
}

std::string ListChoices(std::string_view given, const std::vector<std::string> &choices) {
    if (choices.empty()) return "it takes none";
    std::string nearest;
    size_t best = std::max<size_t>(1, given.size() / 3) + 1;
    for (const std::string &c : choices) {
        size_t d = EditDistance(given, c);
        if (d < best) {
            best = d;
            nearest = c;
        }
    }
    std::string out;
    if (!nearest.empty()) out = fmt::format("did you mean \"{}\"? ", nearest);
    out += "valid: ";
    for (size_t i = 0; i < choices.size(); ++i) out += (i ? ", " : "") + choices[i];
    return out;
}

void CheckFailed(const char *expression, const char *file, int line, const std::string &values) {
    std::fprintf(stderr, "Internal error: %s:%d: check failed: %s%s%s\n", file, line, expression,
                 values.empty() ? "" : ": ", values.c_str());
    std::abort();
}

}  // namespace pbrt
