import { describe, expect, it } from 'vitest';
import { Hands } from './hands';

const drone = { part: 'base' as const, axes: ['x', 'y', 'z', 'yaw'], limits: [1, 1, 1, 1] };
const pad = { axes: [0, -1, 0, 0], buttons: Array.from({ length: 16 }, (_, i) => ({ pressed: i === 5 })) };

describe('hands', () => {
  it('hold keys until they are released', () => {
    const hands = new Hands();
    expect(hands.press('KeyW', false)).toBe(true);
    expect(hands.press('KeyX', false)).toBe(false);
    expect(hands.wish(drone, null)).toEqual({ x: 1 });
    hands.release('KeyW');
    expect(hands.wish(drone, null)).toEqual({});
  });

  it('have two sticks, sliders and a gamepad, which add up', () => {
    const hands = new Hands();
    hands.setMove({ right: -1, up: 0 });
    hands.setTurn({ right: 1, up: 1 });
    hands.setSlider('z', -0.25);
    hands.setSlider('gripper', 1);
    expect(hands.wish(drone, pad)).toEqual({ y: 1, yaw: -1, z: 0.75, x: 1 });
    hands.setMove(null);
    hands.setTurn(null);
    hands.setSlider('z', 0);
    expect(hands.wish(drone, null)).toEqual({});
  });

  it('that drop everything hold nothing until it is pressed anew, though the key repeats', () => {
    const hands = new Hands();
    hands.press('KeyW', false);
    hands.setMove({ right: 0, up: 1 });
    hands.setSlider('z', 1);
    hands.drop();
    hands.press('KeyW', true);
    expect(hands.wish(drone, null)).toEqual({});
    hands.press('KeyW', false);
    expect(hands.wish(drone, null)).toEqual({ x: 1 });
  });
});
