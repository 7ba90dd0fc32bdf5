#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ext/lab/bias_check.h"
#include "ext/lab/text_output.h"

namespace ext::lab {

/// Reason to distrust errors, printed with all results. If it concerns the leader or all samplers, there is no winner.
struct Doubt {
    std::string text;     ///< one or two sentences
    std::string sampler;  ///< label of the sampler concerned; empty: all
};

struct Contender {
    std::string label;
    std::vector<double> errors, trimmedErrors;  ///< final relL2 and trimmed relL2 per seed
    BiasVerdict bias = BiasVerdict::Unknown;
    bool isOracle = false;          ///< reference for measurements, excluded from ranking
    bool firefliesDecide = false;   ///< its error is dominated by a few pixels
    std::optional<double> speedUp;  ///< time of the best other sampler for this error, over this sampler's time
    std::string speedUpAgainst;
};

/// Conclusion of an experiment in sentences, shared by terminal, report.html, table.md and results.json.
struct Conclusion {
    std::optional<size_t> winner;                ///< index; empty if any objection applies
    std::optional<size_t> lowest;                ///< index of the lowest mean error among eligible samplers
    std::string headline;                        ///< lowest error, or "Undecided" and the numbers
    std::vector<std::string> reasons;            ///< why there is no winner; else empty
    std::vector<std::string> doubts;             ///< all doubts, including those among the reasons
    std::vector<std::string> remarks;            ///< additional notes
    std::vector<std::string> Sentences() const;  ///< sentences to show: headline, reasons, other doubts, remarks
};

/// Probability of naming a winner if the best two are equally good. Each lead is tested one-sided at half of it.
inline constexpr double kWinnerLevel = 0.05;

/// Eligible samplers are neither biased nor the oracle. The winner has the lowest mean error of them and leads all
/// others significantly at kWinnerLevel, in trimmed error too if fireflies dominate its error. It has a clean bias
/// verdict, and no doubt concerns it or all samplers. `equalTime`: the budget is time, so the winner must also need the
/// least time for its error.
Conclusion Conclude(const std::vector<Contender> &contenders, const std::vector<Doubt> &doubts,
                    std::vector<std::string> remarks, bool equalTime);

Json ToJson(const Conclusion &conclusion, const std::vector<Contender> &contenders);

}  // namespace ext::lab
