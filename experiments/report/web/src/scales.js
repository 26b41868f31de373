// SPDX-License-Identifier: GPL-3.0-or-later
// The scales of a plot and their ticks, from a chart's points.
import {extent} from "d3-array";
import {scaleLinear, scaleLog} from "d3-scale";
import {plain, sup} from "./text.js";

// The range of one axis over visible series, errors included, with a little room on either side.
export function extentOf(chart, series, axis) {
  const {log, low, high, clip} = chart[axis];
  const [value, error] = axis === "x" ? [0, 2] : [1, 3];
  const ends = series.flatMap(({points}) => points.flatMap((point) =>
    [-1, 0, 1].map((sign) => point[value] + sign * (point[error] ?? 0))));
  if (axis === "y") {
    ends.push(...chart.lines.filter(({vertical}) => !vertical).map(({at}) => at));
  }
  let [least, most] = clip ? [low, high] : extent(ends.filter((end) => !log || end > 0));
  if (!(least <= most)) [least, most] = log ? [0.1, 1] : [low ?? 0, high ?? 1];
  return log ? paddedLog(least, most) : padded(least, most, low, high);
}

function padded(least, most, low, high) {
  least = Math.min(least, low ?? least);
  most = Math.max(most, high ?? most);
  let room = 0.04 * (most - least);
  if (room === 0) room = Math.abs(most) * 0.05 || 1;
  return [least === low ? least : least - room, most === high ? most : most + room];
}

function paddedLog(least, most) {
  const room = Math.max(1.15, (most / least) ** 0.05);
  return [least / room, most * room];
}

export function makeScale(log, domain, range) {
  return (log ? scaleLog() : scaleLinear()).domain(domain).range(range);
}

const minus = (text) => text.replace("-", "−");

// {at, text} of labelled ticks, and the places of the unlabelled ones between them.
// `whole`: only whole numbers have a tick.
export function ticksOf(scale, log, wanted, whole = false) {
  return log ? logTicks(scale, wanted) : linearTicks(scale, wanted, whole);
}

function linearTicks(scale, wanted, whole) {
  const major = scale.ticks(wanted);
  const finerThanWhole = whole && major.length > 1 && major[1] - major[0] < 1 &&
    major.some(Number.isInteger);
  if (finerThanWhole) {
    return {
      major: major.filter(Number.isInteger).map((at) => ({at, text: plain(String(at))})), minor: []
    };
  }
  const format = scale.tickFormat(wanted);
  const step = major.length > 1 ? major[1] - major[0] : 0;
  const [low, high] = scale.domain();
  const minor = [];
  for (let at = (major[0] ?? 0) - step / 2; step > 0 && at < high; at += step) {
    if (at > low) minor.push(at);
  }
  return {major: major.map((at) => ({at, text: plain(minus(format(at)))})), minor};
}

function logTicks(scale, wanted) {
  const [low, high] = scale.domain();
  const decades = Math.log10(high / low);
  if (decades < 1.2) {
    const format = scaleLinear().domain([low, high]).tickFormat(wanted);
    const major = scaleLinear().domain([low, high]).ticks(Math.min(wanted, 4));
    return {major: major.map((at) => ({at, text: plain(format(at))})), minor: []};
  }
  const every = Math.max(1, Math.ceil(decades / wanted));
  const major = [];
  const minor = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power) {
    for (let digit = 1; digit < 10; ++digit) {
      const at = digit * 10 ** power;
      if (at < low || at > high) continue;
      if (digit === 1 && power % every === 0) {
        major.push({at, text: [...plain("10"), ...sup(minus(String(power)))]});
      } else if (digit === 1 || decades < 6) minor.push(at);
    }
  }
  return {major, minor};
}

// Enough digits to tell neighbours apart on this axis and no more.
export function formatOn(scale, value) {
  const [low, high] = scale.domain();
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return minus(String(value));
  if (scale.base) return minus(String(Number(value.toPrecision(3))));  // of a logarithmic axis
  const span = Math.abs(high - low);
  const digits = Math.ceil(-Math.log10(span / 1000));
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    return minus(value.toExponential(3));
  }
  return minus(value.toFixed(Math.min(8, Math.max(0, digits))));
}
