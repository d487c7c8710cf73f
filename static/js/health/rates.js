// Estimated rates as text.

/**
 * A predicted rate as a number of per cent, rounded as the warnings' own words are: a half to the
 * even number. What is hardly ever is told apart from never.
 */
export function percent(rate) {
  const hundredths = 100 * rate;
  const nearest = Math.round(hundredths);
  const rounded = nearest - hundredths === 0.5 && nearest % 2 ? nearest - 1 : nearest;
  return rate > 0 && rounded === 0 ? "<1" : String(rounded);
}

/** A forecast in words, with its interval. */
export const told = ({ rate, low, high }) =>
  `${percent(rate)} % (${percent(low)} to ${percent(high)})`;
