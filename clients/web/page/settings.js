// settings.js: what the page can be told, with defaults; from its address, and from saved files, which are not trusted.

export const LEVELS = { 'guides': 'wisps, evaluated here', 'strands full': 'all strands', 'strands fifth': 'every fifth strand', 'strands guides': 'a strand a wisp' };
export const COLOURS = { brown: [0.13, 0.07, 0.035], black: [0.022, 0.019, 0.018], chestnut: [0.2, 0.07, 0.025], copper: [0.36, 0.1, 0.022], blonde: [0.44, 0.28, 0.12], silver: [0.4, 0.41, 0.43] };

/** Sliders: parameter, what it is called, range; `log`: by powers of ten. */
export const SLIDERS = [
  { name: 'split_threshold', text: 'Split above', least: 0.01, greatest: 10, log: true, value: 0.3 },
  { name: 'merge_velocity', text: 'Merge below', least: 0, greatest: 1, value: 0.15 },
  { name: 'friction_alpha', text: 'Friction', least: 0, greatest: 100, value: 30 },
  { name: 'wind_x', text: 'Wind, aside', least: -10, greatest: 10, value: 0 },
  { name: 'wind_z', text: 'Wind, front', least: -10, greatest: 10, value: 0 },
  { name: 'wind_gust', text: 'Gusts', least: 0, greatest: 3, value: 0 },
];

const PARAMS = [...SLIDERS.map(({ name }) => name), 'links'], WORD = /^[a-z0-9-]{1,32}$/;

/** Takes what is sound of `from` and keeps the rest as it is. */
export function takeSettings(settings, from) {
  const word = (value, otherwise) => (typeof value === 'string' && WORD.test(value) ? value : otherwise);
  const strands = Number(from.strands);
  const params = Object.entries(from.params ?? {}).filter(([name, value]) => PARAMS.includes(name) && Number.isFinite(value));
  return {
    style: word(from.style, settings.style), motion: word(from.motion, settings.motion), colour: from.colour in COLOURS ? from.colour : settings.colour,
    strands: Number.isInteger(strands) && strands >= 1 && strands <= 200000 ? strands : settings.strands,
    level: from.level in LEVELS ? from.level : settings.level, params: from.params ? Object.fromEntries(params) : settings.params,
  };
}

export const DEFAULTS = { style: 'long', strands: 10000, motion: 'mouse', colour: 'brown', level: 'guides', params: {} };

/** { token, settings, and what tests and pictures ask for } of the part of the address behind #. */
export function readAddress(hash) {
  const values = Object.fromEntries(new URLSearchParams(hash.slice(1)));
  return { token: /^[0-9a-f]{32}$/.test(values.token) ? values.token : '', settings: takeSettings(DEFAULTS, values), bare: values.bare === '1', smooth: values.smooth !== '0', coarse: values.coarse === '1' };
}
