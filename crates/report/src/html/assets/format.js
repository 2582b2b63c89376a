"use strict";
// Numbers as people read them, by the rules of the reports' text, but for large ones: there is room for all their digits.

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function superscript(exponent) {
  return [...String(exponent)].map((c) => (c === "-" ? "⁻" : SUPERSCRIPTS[Number(c)])).join("");
}

function fixed(value, decimals) {
  const unit = 10 ** -decimals;
  const text = decimals >= 0 ? value.toFixed(decimals) : (Math.round(value / unit) * unit).toFixed(0);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text.replace("-", "−");
}

function exponentOf(value, digits) {
  return value === 0 ? 0 : Number(value.toExponential(digits - 1).split("e")[1]);
}

const isPlain = (exponent) => exponent > -4 && exponent < 7;

// Whole digits in groups of three with narrow spaces that do not break (ISO 80000-1, 7.3.1), from five digits on.
function grouped(text) {
  const [whole, decimals] = text.split(".");
  const groups = /\d{5}/.test(whole) ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole;
  return decimals === undefined ? groups : `${groups}.${decimals}`;
}

// Four significant digits, or another number of them.
function formatValue(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "n/a";
  const exponent = exponentOf(value, digits);
  const trimmed = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (isPlain(exponent)) return grouped(trimmed(fixed(value, digits - 1 - exponent)));
  return `${trimmed(fixed(value / 10 ** exponent, digits - 1))}×10${superscript(exponent)}`;
}

// A value and its standard error with the digits that the error leaves.
function formatWithError(value, error) {
  if (value === null || error === null) return `${formatValue(value)} ± ${formatValue(error)}`;
  if (error === 0) return `${formatValue(value)} ± 0`;
  // Such an error is rounding.
  if (error < 1e-9 * Math.abs(value)) return `${formatValue(value, 9)} ± 0`;
  const first = exponentOf(error, 3);
  const place = error / 10 ** first < 3.55 ? first - 1 : first;
  const rounded = Math.round(error / 10 ** place) * 10 ** place;
  const exponent = exponentOf(Math.max(Math.abs(value), rounded), 9);
  if (isPlain(exponent)) return `${grouped(fixed(value, -place))} ± ${grouped(fixed(rounded, -place))}`;
  const scaled = (number) => fixed(number / 10 ** exponent, exponent - place);
  return `(${scaled(value)} ± ${scaled(rounded)})×10${superscript(exponent)}`;
}

// The same with its unit, and its bias where there is one.
function quantity(value, error, bias, unit) {
  const suffix = unit === "1" || unit === "" ? "" : ` ${unit}`;
  const biased = bias === null || bias === undefined ? "" : `, bias up to ${formatValue(bias)}${suffix}`;
  return formatWithError(value, error) + suffix + biased;
}
