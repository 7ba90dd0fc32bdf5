#include "fuzz/shrink.h"

#include <algorithm>
#include <cctype>

namespace pbrt::fuzz {

namespace {

std::string Join(const std::vector<std::string> &pieces) {
    std::string all;
    for (const std::string &p : pieces) all += p;
    return all;
}

std::vector<std::string> Lines(const std::string &text) {
    std::vector<std::string> lines;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        lines.push_back(text.substr(at, end - at));
        at = end;
    }
    return lines;
}

/// Words with the white space behind them.
std::vector<std::string> Words(const std::string &text) {
    std::vector<std::string> words;
    bool inSpace = true;
    for (char c : text) {
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (words.empty() || (inSpace && !space)) words.emplace_back();
        words.back() += c;
        inSpace = space;
    }
    return words;
}

std::vector<std::string> Chunks(const std::string &bytes) {
    const size_t size = std::max<size_t>(1, bytes.size() / 64);
    std::vector<std::string> chunks;
    for (size_t at = 0; at < bytes.size(); at += size) chunks.push_back(bytes.substr(at, size));
    return chunks;
}

/// Leaves out runs of consecutive pieces, first half of all, then ever shorter runs, as long as `isGood` holds for the
/// rest.
std::vector<std::string> LeaveOut(std::vector<std::string> pieces,
                                  const std::function<bool(const std::vector<std::string> &)> &isGood) {
    for (size_t run = std::max<size_t>(1, pieces.size() / 2);; run /= 2) {
        for (size_t at = 0; at < pieces.size();) {
            std::vector<std::string> fewer(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(at));
            const size_t end = std::min(at + run, pieces.size());
            fewer.insert(fewer.end(), pieces.begin() + static_cast<std::ptrdiff_t>(end), pieces.end());
            if (isGood(fewer)) pieces = std::move(fewer);
            else at += run;
        }
        if (run <= 1) return pieces;
    }
}

}  // namespace

FuzzCase Shrink(FuzzCase failing, const std::function<bool(const FuzzCase &)> &stillFails, int maxTries) {
    int tries = 0;
    auto fails = [&](const FuzzCase &candidate) { return tries < maxTries && (++tries, stillFails(candidate)); };
    failing.arguments = LeaveOut(failing.arguments, [&](const std::vector<std::string> &arguments) {
        FuzzCase candidate = failing;
        candidate.arguments = arguments;
        return fails(candidate);
    });
    for (size_t i = 0; i < failing.files.size(); ++i) {
        const std::string original = failing.files[i].bytes;
        const bool isText = original.find('\0') == std::string::npos;
        auto split = [&](std::vector<std::string> (*into)(const std::string &)) {
            FuzzCase candidate = failing;
            failing.files[i].bytes =
                Join(LeaveOut(into(failing.files[i].bytes), [&](const std::vector<std::string> &pieces) {
                    candidate.files[i].bytes = Join(pieces);
                    return fails(candidate);
                }));
        };
        if (isText) {
            split(Lines);
            split(Words);
        } else {
            split(Chunks);
        }
    }
    return failing;
}

}  // namespace pbrt::fuzz
