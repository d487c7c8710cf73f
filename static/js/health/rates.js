// Estimated rates as text.

/**
 * An estimated rate in per cent, rounded half to even, as in the texts of the findings. A rate
 * even number. What is hardly ever is rateText apart from never.
 */
export function percent(rate) {
  const hundredths = 100 * rate;
  const nearest = Math.round(hundredths);
  const rounded = nearest - hundredths === 0.5 && nearest % 2 ? nearest - 1 : nearest;
  return rate > 0 && rounded === 0 ? "<1" : String(rounded);
}

/** A estimate in words, with its interval. */
export const rateText = ({ rate, low, high }) =>
  `${percent(rate)} % (${percent(low)} to ${percent(high)})`;
