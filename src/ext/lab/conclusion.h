#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ext/lab/bias_check.h"
#include "ext/lab/text_output.h"

namespace ext::lab {

/// A reason not to trust errors. It is printed wherever results are shown. If it concerns the leader or all samplers,
/// there is no winner.
struct Doubt {
    std::string text;     ///< one or two sentences
    std::string sampler;  ///< label of the only sampler that it concerns; empty: all
};

/// Input of the conclusion: one sampler.
struct Contender {
    std::string label;
    std::vector<double> errors, trimmedErrors;  ///< final relL2 and trimmed relL2, one value per seed
    BiasVerdict bias = BiasVerdict::Unknown;
    bool isOracle = false;          ///< a measuring instrument, which does not compete
    bool firefliesDecide = false;   ///< a few pixels decide its error
    std::optional<double> speedUp;  ///< time that the best other sampler needs for this error, over this sampler's time
    std::string speedUpAgainst;
};

/// The conclusion of an experiment in sentences. It is made once; the terminal, report.html, table.md and results.json
/// all show the same.
struct Conclusion {
    std::optional<size_t> winner;      ///< index; only if nothing speaks against it
    std::optional<size_t> lowest;      ///< index of the lowest mean error among the samplers that may win
    std::string headline;              ///< who has the lowest error, or "Undecided" and what the numbers are
    std::vector<std::string> reasons;  ///< why there is no winner; empty if there is one
    std::vector<std::string> doubts;   ///< all doubts; some are reasons as well
    std::vector<std::string> remarks;  ///< further notes
    /// The sentences to show: headline, reasons, the other doubts, remarks.
    std::vector<std::string> Sentences() const;
};

/// Chance that a winner is named where the best two are equally good. Each lead is tested one-sided at half of that, as
/// either of the two may seem to lead.
inline constexpr double kWinnerLevel = 0.05;

/// Samplers compete if they are neither biased nor the oracle. The winner has the lowest mean error of them; leads
/// every other one beyond noise at kWinnerLevel, in the trimmed error too if fireflies decide its own error; has a
/// clean bias verdict; and no doubt concerns it or all samplers. `equalTime`: the budget is time, so the winner must
/// also need the least time for its error.
Conclusion Conclude(const std::vector<Contender> &contenders, const std::vector<Doubt> &doubts,
                    std::vector<std::string> remarks, bool equalTime);

Json ToJson(const Conclusion &conclusion, const std::vector<Contender> &contenders);

}  // namespace ext::lab
