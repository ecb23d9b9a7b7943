// graph.js: the last seconds of a few figures, each a line of its own with its newest value.

const KEPT = 240;
const ROWS = [
  { name: 'active nodes', of: (s) => s.active, digits: 0, unit: '', colour: '#ffb454' },
  { name: 'step', of: (s) => s.step_ms, digits: 2, unit: ' ms', colour: '#7fd48a' },
  { name: 'encode', of: (s) => s.encode_ms, digits: 2, unit: ' ms', colour: '#6ab7ff' },
  { name: 'age', of: (s) => s.age_ms, digits: 1, unit: ' ms', colour: '#d79bff' },
  { name: 'frame', of: (s) => s.bytes / 1000, digits: 1, unit: ' kB', colour: '#ff8a80' },
];

export class Graph {
  constructor(parent) {
    this.rows = ROWS.map((row) => {
      const line = document.createElement('div'), label = document.createElement('span'), canvas = document.createElement('canvas'), value = document.createElement('output');
      line.className = 'graph-row';
      label.textContent = row.name;
      value.style.color = row.colour;
      Object.assign(canvas, { width: 260, height: 44 });
      line.append(label, canvas, value);
      parent.append(line);
      return { ...row, canvas, value, kept: [] };
    });
  }

  add(stats) {
    for (const row of this.rows) {
      row.kept.push(row.of(stats));
      row.kept.length > KEPT && row.kept.shift();
    }
  }

  draw() {
    for (const { kept, canvas, value, digits, unit, colour } of this.rows) {
      if (kept.length === 0) {
        continue;
      }
      const context = canvas.getContext('2d'), { width, height } = canvas, most = Math.max(...kept) * 1.1 || 1;
      context.clearRect(0, 0, width, height);
      context.strokeStyle = colour;
      context.lineWidth = 2;
      context.beginPath();
      kept.forEach((number, i) => context.lineTo(width - (kept.length - 1 - i) * width / KEPT, height - 3 - number / most * (height - 6)));
      context.stroke();
      value.textContent = kept.at(-1).toFixed(digits) + unit;
    }
  }
}
