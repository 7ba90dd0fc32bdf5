#pragma once
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace pbrt {

/// Text of a scene file, shared by its descriptions so that errors can quote the line.
struct SourceFile {
    std::string name;  ///< as the user would type it
    std::string text;  ///< decompressed content
};

/// Location in a scene file. Lines count from 1, columns from 0 (as in stock pbrt-v4).
struct FileLoc {
    std::shared_ptr<const SourceFile> file;
    int line = 0, column = 0;
    explicit operator bool() const { return file != nullptr && line > 0; }
};

enum class Severity { Warning, Error };

struct Diagnostic {
    Severity severity = Severity::Error;
    FileLoc loc;
    std::string message;
};

/// "Error: FILE:LINE:COLUMN: message", the quoted line, and a caret under the column. Long lines are cut around the
/// column. No trailing newline.
std::string Format(const Diagnostic &d, bool color = false);

/// Limit on errors, and on warnings, that are kept and shown; further ones are only counted.
inline constexpr size_t kMaxDiagnostics = 100;

/// An error in user input. Thrown anywhere below cmd/, caught once in cmd/ (or in build/, which collects errors).
class UserError : public std::runtime_error {
  public:
    explicit UserError(std::string message, FileLoc loc = {});
    template <class... T>
    explicit UserError(fmt::format_string<T...> format, T &&...values)
        : UserError(fmt::format(format, std::forward<T>(values)...)) {}
    template <class... T>
    UserError(FileLoc loc, fmt::format_string<T...> format, T &&...values)
        : UserError(fmt::format(format, std::forward<T>(values)...), std::move(loc)) {}
    /// `omitted`: further errors, counted but not kept.
    explicit UserError(std::vector<Diagnostic> diagnostics, size_t omitted = 0);
    const std::vector<Diagnostic> &Diagnostics() const { return diagnostics_; }
    size_t Omitted() const { return omitted_; }
    size_t Count() const { return diagnostics_.size() + omitted_; }

  private:
    std::vector<Diagnostic> diagnostics_;
    size_t omitted_ = 0;
};

/// All diagnostics in order, then the number of omitted errors; ends with a newline. Linear in the quoted files.
std::string FormatAll(const UserError &e, bool color = false);

/// User text quoted in a message: one line, cut to `maxBytes` and then followed by "...".
std::string Abbreviate(std::string_view text, size_t maxBytes = 60);

/// "1 sample", "2 samples". `plural`: of an irregular noun.
inline std::string CountText(int64_t count, std::string_view noun, std::string_view plural = "") {
    if (count != 1 && !plural.empty()) return fmt::format("{} {}", count, plural);
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// Collects all errors and warnings of a scene, kMaxDiagnostics of each; further errors are counted.
class DiagnosticSink {
  public:
    void Error(const FileLoc &loc, std::string message);
    template <class... T>
    void Error(const FileLoc &loc, fmt::format_string<T...> format, T &&...values) {
        Error(loc, fmt::format(format, std::forward<T>(values)...));
    }
    /// Never fatal; printed by the owner of the sink (cmd/ unless --quiet).
    void Warning(const FileLoc &loc, std::string message);
    template <class... T>
    void Warning(const FileLoc &loc, fmt::format_string<T...> format, T &&...values) {
        Warning(loc, fmt::format(format, std::forward<T>(values)...));
    }
    void Add(const UserError &e) { Add(e.Diagnostics(), e.Omitted()); }
    void Add(const DiagnosticSink &other) { Add(other.All(), other.Omitted()); }

    bool HasErrors() const { return errorCount_ > 0; }
    size_t ErrorCount() const { return errorCount_; }
    /// True if further errors are only counted, so their messages may be cheap.
    bool IsFull() const { return errorCount_ >= kMaxDiagnostics; }
    size_t Omitted() const { return IsFull() ? errorCount_ - kMaxDiagnostics : 0; }
    const std::vector<Diagnostic> &All() const { return diagnostics_; }
    /// Throws one UserError with all collected errors, if any. Warnings stay in the sink.
    void ThrowIfErrors() const {
        if (!HasErrors()) return;
        std::vector<Diagnostic> errors;
        for (const Diagnostic &d : diagnostics_)
            if (d.severity == Severity::Error) errors.push_back(d);
        const size_t omitted = errorCount_ - errors.size();
        throw UserError(std::move(errors), omitted);
    }

  private:
    void Add(const std::vector<Diagnostic> &diagnostics, size_t omitted) {
        for (const Diagnostic &d : diagnostics)
            d.severity == Severity::Error ? Error(d.loc, d.message) : Warning(d.loc, d.message);
        errorCount_ += omitted;
    }
    std::vector<Diagnostic> diagnostics_;
    size_t errorCount_ = 0, warningCount_ = 0;
};

/// Runs `make`, converting its UserError into diagnostics. Returns true on success.
bool Collect(DiagnosticSink &sink, auto &&make) {
    try {
        make();
        return true;
    } catch (const UserError &e) {
        sink.Add(e);
        return false;
    }
}

/// Valid choices for messages: `did you mean "x"? valid: x, y`. The suggestion requires a choice similar to `given`; at
/// most 100 choices are listed.
std::string ListChoices(std::string_view given, const std::vector<std::string> &choices);
/// ListChoices, or `none` if there are no names or the message will be dropped: lists are slow, and there may be many.
std::string ListNames(const DiagnosticSink &sink, std::string_view given, const auto &names, const char *none) {
    return names.empty() || sink.IsFull() ? none : ListChoices(given, {names.begin(), names.end()});
}

[[noreturn]] void CheckFailed(const char *expression, const char *file, int line, const std::string &values);

/// Choice most similar to `given`; empty if none is similar.
std::string NearestChoice(std::string_view given, const std::vector<std::string> &choices);

/// What replaces a name of pbrt-v3 or of an earlier version, as a prefix for the list of valid choices: "it is of
/// pbrt-v3: ...; ". Empty for other names. `what`: the directive whose type it is ("Material"), or "directive",
/// "parameter type", "kind of texture", "parameter", "suffix" (of a light sampler).
std::string OldNameHint(std::string_view what, std::string_view name);

}  // namespace pbrt

/// Aborts with condition and source location if the condition is false, in every build type. For program errors.
#define PBRT_CHECK(condition)                                                   \
    do {                                                                        \
        if (!(condition)) [[unlikely]]                                          \
            ::pbrt::CheckFailed(#condition, __FILE__, __LINE__, std::string()); \
    } while (false)
#define PBRT_CHECK_MSG(condition, ...)                                                     \
    do {                                                                                   \
        if (!(condition)) [[unlikely]]                                                     \
            ::pbrt::CheckFailed(#condition, __FILE__, __LINE__, fmt::format(__VA_ARGS__)); \
    } while (false)
#ifdef NDEBUG
#define PBRT_DCHECK(condition) ((void)0)
#else
#define PBRT_DCHECK(condition) PBRT_CHECK(condition)
#endif
