// panel.js: the controls at the side. It shows settings and tells what was changed; what follows from that is viewer.js's.
import { BUILT_IN } from './clips.js';
import { COLOURS, LEVELS, SLIDERS } from './settings.js';

const find = (id) => document.getElementById(id);

function fill(select, choices) {
  select.replaceChildren(...Object.entries(choices).map(([value, text]) => new Option(text, value)));
}

/* A slider's place is 0 to 1000. */
const toPlace = ({ least, greatest, log }, value) => 1000 * (log ? Math.log(value / least) / Math.log(greatest / least) : (value - least) / (greatest - least));
const toValue = ({ least, greatest, log }, place) => (log ? least * (greatest / least) ** (place / 1000) : least + (greatest - least) * place / 1000);
const shortly = (value) => Number(value.toPrecision(2)).toString();

export class Panel {
  /** `changed(name, value)`: of style, strands, motion, level, colour, tree, or a parameter. `pressed(name)`: of a button. */
  constructor(changed, pressed) {
    fill(find('level'), LEVELS);
    fill(find('colour'), Object.fromEntries(Object.keys(COLOURS).map((name) => [name, name])));
    fill(find('motion'), Object.fromEntries(['mouse', ...BUILT_IN].map((name) => [name, name === 'mouse' ? 'follows the mouse' : name])));
    ['style', 'strands', 'motion', 'level', 'colour'].forEach((id) => find(id).addEventListener('change', () => changed(id, find(id).value)));
    find('links').addEventListener('change', () => changed('links', Number(find('links').value)));
    find('tree').addEventListener('change', () => changed('tree', find('tree').checked));
    ['wheel', 'save', 'share'].forEach((id) => find(id).addEventListener('click', () => pressed(id)));
    ['open', 'load'].forEach((id) => find(id).addEventListener('click', () => find('picker').click()));
    this.sliders = new Map(SLIDERS.map((slider) => [slider.name, this.addSlider(slider, changed)]));
    this.picker = find('picker');
  }

  addSlider(slider, changed) {
    const label = document.createElement('label'), input = document.createElement('input'), output = document.createElement('output');
    Object.assign(input, { type: 'range', min: 0, max: 1000, id: slider.name });
    label.append(slider.text, input, output);
    find('sliders').append(label);
    const put = (value) => {
      input.value = toPlace(slider, value);
      output.textContent = shortly(value);
    };
    input.addEventListener('input', () => {
      const value = toValue(slider, Number(input.value));
      output.textContent = shortly(value);
      changed(slider.name, value);
    });
    put(slider.value);
    return { put, label, standard: slider.value };
  }

  /** Styles and parameters as the daemon lists them. */
  list({ styles, params }) {
    fill(find('style'), Object.fromEntries(styles.map(({ name }) => [name, name])));
    for (const { name, text } of params) {
      const slider = this.sliders.get(name);
      slider && (slider.label.title = text);
    }
  }

  put({ style, strands, motion, level, colour, params }) {
    const choose = (id, value) => {
      if (![...find(id).options].some((option) => option.value === String(value))) {
        find(id).append(new Option(value));
      }
      find(id).value = value;
    };
    Object.entries({ style, strands, motion, level, colour, links: params.links ?? 0 }).forEach(([id, value]) => choose(id, value));
    this.sliders.forEach(({ put, standard }, name) => put(params[name] ?? standard));
  }

  /** `role`: 'drives', 'may' (could take the wheel) or 'looks'. */
  stand(role, name, summary) {
    document.body.classList.toggle('looking', role !== 'drives');
    find('wheel').hidden = role !== 'may';
    find('name').textContent = name;
    find('summary').textContent = summary;
  }

  legend(levels) {
    find('legend').hidden = !levels;
    levels && find('legend').replaceChildren(...levels.flatMap((count, level) => {
      const line = document.createElement('span');
      line.className = `level-${level}`;
      line.textContent = `level ${level}: ${count} active nodes`;
      return count > 0 ? [line] : [];
    }));
  }
}
