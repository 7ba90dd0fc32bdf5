#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/lab/bias_check.h"

namespace pbrt::lab {

/// A reason not to trust errors. Whatever is a doubt is said wherever results are shown, and forbids a winner.
struct Doubt {
    std::string text;     ///< one or two sentences
    std::string sampler;  ///< label of the only one it concerns; empty: all
};

/// One sampler, as far as the conclusion looks at it.
struct Contender {
    std::string label;
    std::vector<double> errors, trimmedErrors;  ///< relL2 at the end, one of each seed
    BiasVerdict bias = BiasVerdict::Unknown;
    bool isOracle = false;          ///< an instrument, no competitor
    bool firefliesDecide = false;   ///< a few pixels decide its error
    std::optional<double> speedUp;  ///< time the best other one needs for this error, over this one's
    std::string speedUpAgainst;
};

/// What a campaign says, for people, made once: the terminal, report.html, table.md and results.json all show these
/// sentences.
struct Conclusion {
    std::optional<size_t> winner;      ///< only if nothing speaks against it
    std::optional<size_t> lowest;      ///< of those that may win, the one with the lowest mean error
    std::string headline;              ///< who has the lowest error, or "Undecided" and what the numbers are
    std::vector<std::string> reasons;  ///< why there is no winner; empty if there is one
    std::vector<std::string> doubts;   ///< all of them; some are reasons as well
    std::vector<std::string> remarks;  ///< what else people should know
    /// What is shown: headline, reasons, the other doubts, remarks.
    std::vector<std::string> Sentences() const;
};

/// Chance that a winner is named where the best two are equally good. Each lead is tested one-sided at half of that, as
/// either of the two may seem to lead.
inline constexpr double kWinnerLevel = 0.05;

/// The rules for a winner: the lowest mean error of those that compete (neither biased nor the oracle); a lead beyond
/// noise over every other of them, at kWinnerLevel, and in the trimmed error too where fireflies decide its own; a
/// clean bias verdict; no doubt about it or all. `equalTime`: the budget is time, so who leads must need least time as
/// well.
Conclusion Conclude(const std::vector<Contender> &contenders, const std::vector<Doubt> &doubts,
                    std::vector<std::string> remarks, bool equalTime);

nlohmann::ordered_json ToJson(const Conclusion &conclusion, const std::vector<Contender> &contenders);

}  // namespace pbrt::lab
