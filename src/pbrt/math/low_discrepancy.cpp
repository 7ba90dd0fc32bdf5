#include "pbrt/math/low_discrepancy.h"

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

constexpr std::array<uint16_t, PrimeCount> FirstPrimes() {
    std::array<uint16_t, PrimeCount> primes{};
    size_t n = 0;
    for (uint16_t candidate = 2; n < primes.size(); ++candidate) {
        bool prime = true;
        for (size_t i = 0; i < n && primes[i] * primes[i] <= candidate && prime; ++i)
            prime = candidate % primes[i] != 0;
        if (prime) primes[n++] = candidate;
    }
    return primes;
}

/// Number of digits in `base` that determine a value within 2^-32.
int DigitsOf(uint32_t base) {
    int digits = 0;
    for (double power = 1; power < 0x1p32; power *= double(base)) ++digits;
    return digits;
}

Float ToUnitInterval(double v) { return std::min(Float(v), OneMinusEpsilon); }

/// Radical inverse with the k-th digit replaced by permute(k, digit), down to 2^-32.
Float DigitwiseInverse(uint32_t base, uint64_t a, auto permute) {
    double scale = 1 / double(base), weight = scale, value = 0;
    int digits = DigitsOf(base);
    for (int k = 0; k < digits; ++k) {
        value += double(permute(k, uint32_t(a % base))) * weight;
        weight *= scale;
        a /= base;
    }
    return ToUnitInterval(value);
}

}  // namespace

constinit const std::array<uint16_t, PrimeCount> Primes = FirstPrimes();

Float RadicalInverse(uint32_t base, uint64_t a) {
    double scale = 1 / double(base), weight = scale, value = 0;
    while (a) {
        uint64_t next = a / base;
        value += double(a - next * base) * weight;
        weight *= scale;
        a = next;
    }
    return ToUnitInterval(value);
}

uint64_t InverseRadicalInverse(uint64_t mirrored, uint32_t base, int digits) {
    uint64_t a = 0;
    for (int i = 0; i < digits; ++i) {
        a = a * base + mirrored % base;
        mirrored /= base;
    }
    return a;
}

Float PermutedRadicalInverse(uint32_t base, uint64_t a, uint64_t seed) {
    return DigitwiseInverse(base, a, [&](int k, uint32_t digit) {
        return PermutationElement(digit, base, seed + 0x9e3779b97f4a7c15ull * uint64_t(k));
    });
}

Float OwenScrambledRadicalInverse(uint32_t base, uint64_t a, uint64_t seed) {
    uint64_t node = seed;  // hash of the preceding digits
    return DigitwiseInverse(base, a, [&](int, uint32_t digit) {
        const uint32_t permuted = PermutationElement(digit, base, node);
        node = MixBits(node + 0x9e3779b97f4a7c15ull * (digit + 1));
        return permuted;
    });
}

DigitPermutations::DigitPermutations(std::span<const uint32_t> multipliers, uint64_t seed)
    : length_(multipliers.size() + Lanes64Count), base_(length_, 2), inverseBase_(length_, 0.5),
      multiplier_(length_, 1) {
    PBRT_CHECK(multipliers.size() <= size_t(PrimeCount));
    const int maxDigits = DigitsOf(2);
    shifts_.resize(maxDigits * length_);
    tails_.resize((maxDigits + 1) * length_);
    for (size_t d = 0; d < multipliers.size(); ++d) {
        const uint32_t base = Primes[d];
        PBRT_CHECK(multipliers[d] > 0 && multipliers[d] < base);
        digits_.push_back(DigitsOf(base));
        base_[d] = base;
        inverseBase_[d] = 1 / double(base);
        multiplier_[d] = multipliers[d];
        const uint64_t baseSeed = SeedOf(seed, int(d));
        for (int k = digits_[d] - 1; k >= 0; --k) {
            const uint64_t hash = MixBits(baseSeed + 0x9e3779b97f4a7c15ull * uint64_t(k + 1));
            const double shift = double((hash >> 32) * base >> 32);
            shifts_[k * length_ + d] = shift;
            tails_[k * length_ + d] = tails_[(k + 1) * length_ + d] + shift * std::pow(double(base), -(k + 1));
        }
    }
}

void DigitPermutations::RadicalInverses(int firstDimension, uint64_t a, Float values[Lanes64Count]) const {
    const auto d = size_t(firstDimension);
    auto row = [&](const std::vector<double> &rows, size_t k) {
        return LoadLanes<DoubleLanes>(rows.data() + k * length_ + d);
    };
    const DoubleLanes base = row(base_, 0), inverse = row(inverseBase_, 0), multiplier = row(multiplier_, 0);
    // floor(a / base) for integers below 2^50. Adding one half keeps product rounding from reaching an integer; sums at
    // the size of kRound round to integers.
    constexpr double kRound = 0x1.8p52;
    const DoubleLanes half = 0.5 * inverse - 0.5;
    auto quotient = [&](const DoubleLanes &v) { return ((v * inverse + half) + kRound) - kRound; };
    // The smallest base has the most digits.
    size_t digits = 0;
    for (uint64_t rest = a; rest; rest /= Primes[d]) ++digits;
    digits = std::min(digits, size_t(digits_[d]));

    DoubleLanes left = DoubleLanes{} + double(a), weight = inverse, value{};
    Lanes64 count{};
    for (size_t k = 0; k < digits; ++k) {
        const auto isDigit = left > 0.5;
        const DoubleLanes next = quotient(left), digit = left - next * base;
        const DoubleLanes product = multiplier * digit + row(shifts_, k);
        const DoubleLanes permuted = product - quotient(product) * base;
        value += isDigit ? permuted * weight : DoubleLanes{};
        count -= reinterpret_cast<Lanes64>(isDigit);  // true is all bits set
        weight *= inverse;
        left = next;
    }
    for (size_t lane = 0; lane < Lanes64Count; ++lane)
        values[lane] = ToUnitInterval(value[lane] + tails_[count[lane] * length_ + d + lane]);
}

}  // namespace pbrt
