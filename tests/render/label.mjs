// label.mjs: small letters on a picture: a fixed font of 5 x 7 dots, drawn by us.

const ROWS = 7;
/* seven rows of five dots each, a digit in base 32 a row, the leftmost dot the greatest */
const GLYPHS = {
  a: '00e1fhf', b: 'ggmphhu', c: '00eggge', d: '11djhhf', e: '00ehvge', f: '698s888', g: '0fhhf1e', h: 'ggmphhh',
  i: '40c444e', j: '20622ic', k: 'ggikoki', l: 'c44444e', m: '00qllhh', n: '00mphhh', o: '00ehhhe', p: '00uhugg',
  q: '00djf11', r: '00mpggg', s: '00fge1u', t: '88s8896', u: '00hhhjd', v: '00hhha4', w: '00hhlla', x: '00ha4ah',
  y: '0hhhf1e', z: '00v248v', 0: 'ehjlphe', 1: '4c4444e', 2: 'eh1248v', 3: 'v2421he', 4: '26aiv22', 5: 'vgu11he',
  6: '68guhhe', 7: 'v124888', 8: 'ehhehhe', 9: 'ehhf12c', '.': '0000066', ',': '00006c8', '-': '000v000',
  ' ': '0000000',
};

/** Writes `text` (small letters, digits, . , -) onto picture { width, rgb } with its upper left corner at x, y. */
export function drawLabel(picture, text, x, y, [r, g, b] = [40, 40, 44]) {
  [...text].forEach((letter, n) => {
    const rows = GLYPHS[letter] ?? GLYPHS[' '];
    for (let row = 0; row < ROWS; row++) {
      const dots = parseInt(rows[row], 32);
      for (let dot = 0; dot < 5; dot++) {
        const column = x + 6 * n + dot;
        if (dots >> (4 - dot) & 1 && column < picture.width) {
          picture.rgb.set([r, g, b], 3 * ((y + row) * picture.width + column));
        }
      }
    }
  });
}
