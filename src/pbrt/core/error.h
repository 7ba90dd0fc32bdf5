#pragma once
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace pbrt {

/// The text of one scene file, kept while its descriptions live so that errors can quote the line.
struct SourceFile {
    std::string name;  ///< as the user would type it
    std::string text;  ///< decompressed content
};

/// A place in a scene file. Lines count from 1, columns from 0 (as stock pbrt-v4 prints them).
struct FileLoc {
    std::shared_ptr<const SourceFile> file;
    int line = 0;
    int column = 0;
    explicit operator bool() const { return file != nullptr && line > 0; }
};

enum class Severity { Warning, Error };

struct Diagnostic {
    Severity severity = Severity::Error;
    FileLoc loc;
    std::string message;
};

/// "Error: FILE:LINE:COLUMN: message", then the quoted line and a caret under the column. Very long lines are
/// cut around the column. No trailing newline.
std::string Format(const Diagnostic &d, bool color = false);

/// At most this many errors, and as many warnings, are kept and shown; further ones are only counted.
inline constexpr size_t kMaxDiagnostics = 100;

/// A mistake of the user, not of the program. Thrown anywhere below cmd/, caught once in cmd/ (or in build/, which
/// collects many).
class UserError : public std::runtime_error {
  public:
    explicit UserError(std::string message, FileLoc loc = {});
    /// `omitted`: errors beside these that were counted but not kept.
    explicit UserError(std::vector<Diagnostic> diagnostics, size_t omitted = 0);
    const std::vector<Diagnostic> &Diagnostics() const { return diagnostics_; }
    size_t Omitted() const { return omitted_; }
    size_t Count() const { return diagnostics_.size() + omitted_; }

  private:
    std::vector<Diagnostic> diagnostics_;
    size_t omitted_ = 0;
};

/// All diagnostics of the error, one after the other, then the number of errors that are not shown; ends with a
/// newline. Takes time that is linear in the size of the quoted files.
std::string FormatAll(const UserError &e, bool color = false);

/// `text` (written by the user) as messages quote it: in one line, cut to `maxBytes` and then followed by "...".
std::string Abbreviate(std::string_view text, size_t maxBytes = 60);

/// Collects everything wrong with a scene so that the user sees all of it at once: the first kMaxDiagnostics errors and
/// as many warnings, and the number of the other errors.
class DiagnosticSink {
  public:
    void Error(const FileLoc &loc, std::string message);
    /// Printed by the owner of the sink (cmd/ unless --quiet); never fatal.
    void Warning(const FileLoc &loc, std::string message);
    /// Adds the diagnostics of an exception.
    void Add(const UserError &e);
    /// Adds the diagnostics of another sink.
    void Add(const DiagnosticSink &other);

    bool HasErrors() const { return errorCount_ > 0; }
    size_t ErrorCount() const { return errorCount_; }
    /// True if a further error would only be counted: its message need not be composed with care.
    bool IsFull() const { return errorCount_ >= kMaxDiagnostics; }
    /// Errors that were counted but not kept.
    size_t Omitted() const { return IsFull() ? errorCount_ - kMaxDiagnostics : 0; }
    const std::vector<Diagnostic> &All() const { return diagnostics_; }
    /// Throws one UserError with every error collected so far, if there is any. Warnings stay in the sink.
    void ThrowIfErrors() const;

  private:
    std::vector<Diagnostic> diagnostics_;
    size_t errorCount_ = 0, warningCount_ = 0;
};

/// The valid choices as a text for messages: `did you mean "x"? valid: x, y`. The question is asked only if one choice
/// is similar to `given`; of many choices only the first 100 are listed.
std::string ListChoices(std::string_view given, const std::vector<std::string> &choices);

[[noreturn]] void CheckFailed(const char *expression, const char *file, int line, const std::string &values);

/// The choice that `given` may be a misspelling of; empty if none is similar.
std::string NearestChoice(std::string_view given, const std::vector<std::string> &choices);

}  // namespace pbrt

/// Aborts if the condition is false, after printing it and its place. For bugs of the program, in every build type; not
/// for user input.
#define PBRT_CHECK(condition)                                                   \
    do {                                                                        \
        if (!(condition)) [[unlikely]]                                          \
            ::pbrt::CheckFailed(#condition, __FILE__, __LINE__, std::string()); \
    } while (false)
/// As PBRT_CHECK with a formatted explanation of the values involved.
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
