//! The pattern of a symmetric matrix in another order of its dofs, found once for all matrices on it.

/// Lower triangle of a pattern by columns, rows and columns in the order of the factor.
pub struct Reordered {
    pub col_ptr: Vec<usize>,
    pub row_idx: Vec<usize>,
    /// Where every entry stands in the pattern as it was given.
    pub from: Vec<usize>,
}

impl Reordered {
    /// From the lower triangle by columns and the place of every dof in the factor.
    pub fn new(col_ptr: &[usize], row_idx: &[usize], place: &[usize]) -> Reordered {
        let n = place.len();
        let entries = |visit: &mut dyn FnMut(usize, usize, usize)| {
            for j in 0..n {
                for at in col_ptr[j]..col_ptr[j + 1] {
                    let (a, b) = (place[row_idx[at]], place[j]);
                    visit(a.max(b), a.min(b), at);
                }
            }
        };
        let mut next = vec![0; n + 1];
        entries(&mut |_, column, _| next[column + 1] += 1);
        for j in 0..n {
            next[j + 1] += next[j];
        }
        let starts = next.clone();
        let (mut rows, mut from) = (vec![0; row_idx.len()], vec![0; row_idx.len()]);
        entries(&mut |row, column, at| {
            rows[next[column]] = row;
            from[next[column]] = at;
            next[column] += 1;
        });
        Reordered {
            col_ptr: starts,
            row_idx: rows,
            from,
        }
    }
}
