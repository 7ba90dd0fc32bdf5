#include "pbrt/core/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace pbrt {
namespace {

/// Where the lines of files begin; each file is indexed once.
using LineBegins = std::map<const SourceFile *, std::vector<size_t>>;

std::string_view LineAt(const FileLoc &loc, LineBegins &known) {
    const std::string_view text = loc.file->text;
    auto [found, isNew] = known.try_emplace(loc.file.get());
    std::vector<size_t> &begins = found->second;
    if (isNew) {
        begins.push_back(0);
        for (size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1)) begins.push_back(at + 1);
        begins.push_back(text.size() + 1);
    }
    const auto line = size_t(loc.line);
    if (line >= begins.size()) return {};
    std::string_view shown = text.substr(begins[line - 1], begins[line] - begins[line - 1] - 1);
    if (shown.ends_with('\r')) shown.remove_suffix(1);
    return shown;
}

/// Line at `loc`, with tabs replaced by blanks and cut to about 100 characters around the column; column in this text.
std::pair<std::string, size_t> QuoteLine(const FileLoc &loc, LineBegins &lines) {
    constexpr size_t kWidth = 100;
    const std::string_view line = LineAt(loc, lines);
    size_t caret = std::min(size_t(std::max(0, loc.column)), line.size()), from = 0;
    if (line.size() > kWidth && caret > kWidth / 2) from = std::min(caret - kWidth / 2, line.size() - kWidth);
    std::string text(line.substr(from, kWidth));
    for (char &c : text)
        if (static_cast<unsigned char>(c) < 32) c = ' ';
    caret -= from;
    if (from > 0) {
        text.insert(0, "...");
        caret += 3;
    }
    if (from + kWidth < line.size()) text += "...";
    return {std::move(text), caret};
}

std::string Heading(const Diagnostic &d, bool color) {
    const char *word = d.severity == Severity::Error ? "Error" : "Warning";
    std::string out = color ? fmt::format("\033[1;31m{}\033[0m: ", word) : fmt::format("{}: ", word);
    if (d.loc.file) {
        out += d.loc.file->name;
        if (d.loc.line > 0) out += fmt::format(":{}:{}", d.loc.line, d.loc.column);
        out += ": ";
    }
    return out + d.message;
}

std::string Format(const Diagnostic &d, bool color, LineBegins &lines) {
    std::string out = Heading(d, color);
    if (d.loc) {
        const auto [text, caret] = QuoteLine(d.loc, lines);
        if (!text.empty()) out += fmt::format("\n    {}\n    {}^", text, std::string(caret, ' '));
    }
    return out;
}

std::string CutMonster(std::string message) {
    constexpr size_t kMax = 4000, kTail = 1000;
    if (message.size() > kMax) message.replace(kMax - kTail, message.size() - kMax, " ... ");
    return message;
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

/// Takes time independent of file sizes, because thousands of errors may be thrown and caught.
std::string Summarize(const std::vector<Diagnostic> &diagnostics, size_t omitted) {
    if (diagnostics.empty()) return {};
    const size_t others = diagnostics.size() - 1 + omitted;
    std::string first = Heading(diagnostics.front(), false);
    return others > 0 ? fmt::format("{}\n({})", first, CountText(others, "more error")) : first;
}

}  // namespace

std::string Format(const Diagnostic &d, bool color) {
    LineBegins lines;
    return Format(d, color, lines);
}

std::string FormatAll(const UserError &e, bool color) {
    LineBegins lines;
    std::string out;
    for (const Diagnostic &d : e.Diagnostics()) out += Format(d, color, lines) + '\n';
    if (e.Omitted() > 0) out += fmt::format("... and {} not shown.\n", CountText(e.Omitted(), "more error"));
    return out;
}

std::string Abbreviate(std::string_view text, size_t maxBytes) {
    std::string shown(text.substr(0, maxBytes));
    if (text.size() > maxBytes) {
        // Not inside a UTF-8 sequence.
        while (!shown.empty() && (static_cast<unsigned char>(text[shown.size()]) & 0xc0) == 0x80) shown.pop_back();
        shown += "...";
    }
    for (char &c : shown)
        if (static_cast<unsigned char>(c) < 32) c = ' ';
    return shown;
}

UserError::UserError(std::string message, FileLoc loc)
    : UserError(std::vector<Diagnostic>{{Severity::Error, std::move(loc), CutMonster(std::move(message))}}) {}

UserError::UserError(std::vector<Diagnostic> diagnostics, size_t omitted)
    : std::runtime_error(Summarize(diagnostics, omitted)), diagnostics_(std::move(diagnostics)), omitted_(omitted) {}

void DiagnosticSink::Error(const FileLoc &loc, std::string message) {
    if (errorCount_++ < kMaxDiagnostics) diagnostics_.push_back({Severity::Error, loc, CutMonster(std::move(message))});
}

void DiagnosticSink::Warning(const FileLoc &loc, std::string message) {
    if (++warningCount_ <= kMaxDiagnostics)
        diagnostics_.push_back({Severity::Warning, loc, CutMonster(std::move(message))});
    else if (warningCount_ == kMaxDiagnostics + 1)
        diagnostics_.push_back({Severity::Warning, {}, "there are more warnings, which are not shown."});
}

std::string NearestChoice(std::string_view given, const std::vector<std::string> &choices) {
    constexpr size_t kMaxCompared = 100;  // bytes; longer names get no suggestion
    std::string nearest;
    if (given.size() > kMaxCompared) return nearest;
    size_t best = std::max<size_t>(1, given.size() / 3) + 1;
    for (const std::string &c : choices) {
        if (std::max(given.size(), c.size()) - std::min(given.size(), c.size()) >= best) continue;
        size_t d = EditDistance(given, c);
        if (d < best) {
            best = d;
            nearest = c;
        }
    }
    return nearest;
}

std::string ListChoices(std::string_view given, const std::vector<std::string> &choices) {
    if (choices.empty()) return "it takes none";
    const std::string nearest = NearestChoice(given, choices);
    std::string out;
    if (!nearest.empty()) out = fmt::format("did you mean \"{}\"? ", Abbreviate(nearest));
    out += "valid: ";
    constexpr size_t kMaxListed = 100;
    const size_t listed = choices.size() <= kMaxListed + 1 ? choices.size() : kMaxListed;
    for (size_t i = 0; i < listed; ++i) out += (i ? ", " : "") + Abbreviate(choices[i]);
    if (listed < choices.size()) out += fmt::format(" and {} more", choices.size() - listed);
    return out;
}

void CheckFailed(const char *expression, const char *file, int line, const std::string &values) {
    std::fprintf(stderr, "Internal error: %s:%d: check failed: %s%s%s\n", file, line, expression,
                 values.empty() ? "" : ": ", values.c_str());
    std::abort();
}

}  // namespace pbrt
